// SPDX-License-Identifier: MIT
#include "core/path/impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <boost/math/tools/toms748_solve.hpp>

namespace tactor::detail {
namespace {

constexpr unsigned deepest = 48;

struct interval {
    double from;
    double to;
    double length;
    unsigned depth = 0;
};

// Returns true if the speed has a kink at an end of the interval. Near a cusp the kink, or near-kink, may be
// narrower than the gaps between the nodes, so comparing lengths does not find it. Cusps are ends of
// intervals: there, the speed must be even before the interval may be large enough to matter.
bool kink_at_end(const shape& c, const interval& i)
{
    constexpr double harmless_mm = 1e-6;
    const double mean = i.length / (i.to - i.from);
    return i.length > harmless_mm && std::min(speed(c, i.from), speed(c, i.to)) < 0.1 * mean;
}

/// Two entries of the table around the wanted length, and the distances of their lengths from it.
struct bracket {
    double from;
    double to;
    double below;
    double above;
    double first_speed;
    double last_speed;
};

/// Returns a first guess between two entries: the cubic in s with the right slopes at both ends, or the chord
/// if the cubic leaves the interval.
double guess(const bracket& b)
{
    const auto& [from, to, below, above, first_speed, last_speed] = b;
    const double all = above - below;
    const double u = -below / all;
    const double chord = from + u * (to - from);
    const double first = all / first_speed - (to - from);
    const double last = all / last_speed - (to - from);
    const double t = chord + u * (1.0 - u) * ((1.0 - u) * first - u * last);
    return t > from && t < to ? t : chord;
}

/// Finds the parameter at which the length from `from` equals -below. Takes two or three of Halley's steps.
/// Returns nothing if they do not converge, as near cusps.
std::optional<double> newton(const shape& c, const bracket& b)
{
    const double from = b.from;
    const double to = b.to;
    constexpr int most_steps = 5;
    // Halley's method is cubic: the next step would be below the last digit.
    constexpr double settled = 1e-6;
    double t = guess(b);
    for (int i = 0; i < most_steps; ++i) {
        const double off = b.below + length_between(c, from, t);
        const speed_change v = speed_and_rate(c, t);
        const double straight = off / v.speed;
        const double step = straight / (1.0 - 0.5 * straight * v.rate / v.speed);
        t -= step;
        if (!(t >= from && t <= to && std::abs(step) <= to - from))
            return {};
        if (std::abs(step) <= settled * (to - from) && std::abs(straight * v.rate) <= 1e-3 * v.speed)
            return t;
    }
    return {};
}

} // namespace

// Halves intervals until the two halves of each give the same length as the whole.
arc_length::arc_length(const shape& c) : even_(is_even(c)), t_{0.0}, s_{0.0}
{
    const double tolerance = std::max(1e-10, 1e-14 * rough_length(c));
    std::vector<double> ends = speed_turns(c);
    ends.push_back(1.0);
    for (const double end : ends) {
        if (end <= t_.back())
            continue;
        std::vector<interval> open{{t_.back(), end, length_between(c, t_.back(), end)}};
        while (!open.empty()) {
            const interval i = open.back();
            open.pop_back();
            const double middle = 0.5 * (i.from + i.to);
            const double left = length_between(c, i.from, middle);
            const double right = length_between(c, middle, i.to);
            const bool same = std::abs(left + right - i.length) <= tolerance;
            if (i.depth == deepest || (same && !kink_at_end(c, i))) {
                t_.push_back(i.to);
                s_.push_back(s_.back() + i.length);
            } else {
                open.push_back({middle, i.to, right, i.depth + 1});
                open.push_back({i.from, middle, left, i.depth + 1});
            }
        }
    }
    if (even_)
        return;
    speed_.reserve(t_.size());
    for (const double t : t_)
        speed_.push_back(speed(c, t));
}

double arc_length::at(const shape& c, double t) const noexcept
{
    if (!(t > 0.0))
        return 0.0;
    if (t >= 1.0)
        return total();
    if (even_)
        return t * total();
    const auto k = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin()) - 1;
    return std::min(s_[k] + length_between(c, t_[k], t), s_[k + 1]);
}

double arc_length::parameter(const shape& c, double s_mm) const noexcept
{
    if (!(s_mm > 0.0))
        return 0.0;
    if (s_mm >= total())
        return 1.0;
    if (even_)
        return s_mm / total();
    const auto k = static_cast<std::size_t>(std::upper_bound(s_.begin(), s_.end(), s_mm) - s_.begin()) - 1;
    const auto excess = [&](double t) { return s_[k] + length_between(c, t_[k], t) - s_mm; };
    const double below = s_[k] - s_mm;
    const double above = s_[k + 1] - s_mm;
    if (!(below < 0.0))
        return t_[k];
    if (const auto t = newton(c, {t_[k], t_[k + 1], below, above, speed_[k], speed_[k + 1]}))
        return *t;
    std::uintmax_t steps = 64;
    const auto [low, high] = boost::math::tools::toms748_solve(
        excess, t_[k], t_[k + 1], below, above, boost::math::tools::eps_tolerance<double>(51), steps);
    return 0.5 * (low + high);
}

} // namespace tactor::detail
