// SPDX-License-Identifier: MIT
#include "plan/brush_timing.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace tactor::detail {
namespace {

// A part that is negative by a rounding error is none.
constexpr double slack_s = 1e-10;

bool possible(double part_s)
{
    return part_s >= -slack_s;
}

/// Virtual tactors in path order, from which interior ones are taken out. After one goes, the parts of
/// those behind it are corrected as far as they change: the law forgets by (1 - slope) / (1 + slope) a step.
class chain {
public:
    chain(const timing_profile& p, const std::vector<double>& tau_s)
        : profile_(p),
          tau_(tau_s),
          before_(tau_s.size()),
          after_(tau_s.size()),
          part_(tau_s.size(), 0.0),
          left_out_(tau_s.size(), false)
    {
        for (std::size_t i = 0; i < tau_.size(); ++i) {
            before_[i] = i - 1;
            after_[i] = i + 1;
            if (i > 0)
                part_[i] = computed(i);
            impossible_ += possible(part_[i]) ? 0 : 1;
        }
        for (std::size_t i = 1; i + 1 < tau_.size(); ++i)
            by_gap_.insert({gap(i), i});
    }

    bool done() const { return impossible_ == 0 || by_gap_.empty(); }

    void drop_one()
    {
        const std::size_t i = by_gap_.begin()->second;
        const std::size_t a = before_[i];
        const std::size_t b = after_[i];
        for (const std::size_t k : {a, i, b})
            if (interior(k))
                by_gap_.erase({gap(k), k});
        impossible_ -= possible(part_[i]) ? 0 : 1;
        left_out_[i] = true;
        after_[a] = b;
        before_[b] = a;
        for (const std::size_t k : {a, b})
            if (interior(k))
                by_gap_.insert({gap(k), k});
        correct_from(b);
    }

    std::vector<std::size_t> left() const
    {
        std::vector<std::size_t> places;
        for (std::size_t i = 0; i < tau_.size(); ++i)
            if (!left_out_[i])
                places.push_back(i);
        return places;
    }

private:
    bool interior(std::size_t i) const { return i > 0 && i + 1 < tau_.size(); }

    double computed(std::size_t i) const
    {
        return next_part_s(profile_, tau_[i] - tau_[before_[i]], part_[before_[i]]);
    }

    /// Whole nanoseconds, so that equal gaps tie and the first one goes.
    long long gap(std::size_t i) const
    {
        return std::llround(std::min(tau_[i] - tau_[before_[i]], tau_[after_[i]] - tau_[i]) * 1e9);
    }

    void correct_from(std::size_t i)
    {
        for (; i < tau_.size(); i = after_[i]) {
            const double part = computed(i);
            if (part == part_[i])
                return;
            impossible_ += (possible(part) ? 0 : 1) - (possible(part_[i]) ? 0 : 1);
            part_[i] = part;
        }
    }

    const timing_profile& profile_;
    const std::vector<double>& tau_;
    std::vector<std::size_t> before_;
    std::vector<std::size_t> after_;
    std::vector<double> part_;
    std::vector<bool> left_out_;
    std::set<std::pair<long long, std::size_t>> by_gap_;
    long impossible_ = 0;
};

} // namespace

double next_part_s(const timing_profile& p, double gap_s, double part_s)
{
    return (gap_s - p.intercept_s + (1.0 - p.slope) * part_s) / (1.0 + p.slope);
}

std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s)
{
    std::vector<double> parts{0.0};
    for (std::size_t i = 1; i < tau_s.size(); ++i) {
        const double part = next_part_s(p, tau_s[i] - tau_s[i - 1], parts.back());
        if (!possible(part))
            return {};
        parts.push_back(std::max(part, 0.0));
    }
    return parts;
}

double shortest_duration_s(const timing_profile& p, const std::vector<double>& tau_s)
{
    // part = grow * T + fixed, with tau_i = share_i * T.
    double grow = 0.0;
    double fixed = 0.0;
    double shortest = 0.0;
    for (std::size_t i = 1; i < tau_s.size(); ++i) {
        const double share = (tau_s[i] - tau_s[i - 1]) / tau_s.back();
        grow = (share + (1.0 - p.slope) * grow) / (1.0 + p.slope);
        fixed = (-p.intercept_s + (1.0 - p.slope) * fixed) / (1.0 + p.slope);
        shortest = std::max(shortest, -fixed / grow);
    }
    return shortest;
}

std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s)
{
    chain c(p, tau_s);
    while (!c.done())
        c.drop_one();
    return c.left();
}

} // namespace tactor::detail
