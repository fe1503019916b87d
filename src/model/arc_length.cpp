// SPDX-License-Identifier: MIT
#include "model/arc_length.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/toms748_solve.hpp>

namespace tactor::detail {
namespace {

constexpr unsigned deepest = 48;

double gauss(const shape& c, double from, double to)
{
    return boost::math::quadrature::gauss<double, 15>::integrate([&c](double t) { return speed(c, t); }, from,
                                                                 to);
}

struct interval {
    double from;
    double to;
    double length;
    unsigned depth = 0;
};

// Near a cusp the speed has a kink, or nearly one, in a stretch that may be narrower than the gaps between
// the nodes, so comparing lengths does not find it. Cusps are ends of intervals: there, the speed must be
// seen to be even before the interval is large enough to matter.
bool kink_at_end(const shape& c, const interval& i)
{
    constexpr double harmless_mm = 1e-6;
    const double mean = i.length / (i.to - i.from);
    return i.length > harmless_mm && std::min(speed(c, i.from), speed(c, i.to)) < 0.1 * mean;
}

} // namespace

// An interval is fine enough when its two halves give the same length.
arc_length::arc_length(const shape& c) : t_{0.0}, s_{0.0}
{
    const double tolerance = std::max(1e-10, 1e-14 * rough_length(c));
    std::vector<double> ends = speed_turns(c);
    ends.push_back(1.0);
    for (const double end : ends) {
        if (end <= t_.back())
            continue;
        std::vector<interval> open{{t_.back(), end, gauss(c, t_.back(), end)}};
        while (!open.empty()) {
            const interval i = open.back();
            open.pop_back();
            const double middle = 0.5 * (i.from + i.to);
            const double left = gauss(c, i.from, middle);
            const double right = gauss(c, middle, i.to);
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
}

double arc_length::at(const shape& c, double t) const noexcept
{
    if (!(t > 0.0))
        return 0.0;
    if (t >= 1.0)
        return total();
    const auto k = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin()) - 1;
    return std::min(s_[k] + gauss(c, t_[k], t), s_[k + 1]);
}

double arc_length::parameter(const shape& c, double s_mm) const noexcept
{
    if (!(s_mm > 0.0))
        return 0.0;
    if (s_mm >= total())
        return 1.0;
    const auto k = static_cast<std::size_t>(std::upper_bound(s_.begin(), s_.end(), s_mm) - s_.begin()) - 1;
    const auto excess = [&](double t) { return s_[k] + gauss(c, t_[k], t) - s_mm; };
    const double below = s_[k] - s_mm;
    const double above = s_[k + 1] - s_mm;
    if (!(below < 0.0))
        return t_[k];
    std::uintmax_t steps = 64;
    const auto [low, high] = boost::math::tools::toms748_solve(
        excess, t_[k], t_[k + 1], below, above, boost::math::tools::eps_tolerance<double>(51), steps);
    return 0.5 * (low + high);
}

} // namespace tactor::detail
