// SPDX-License-Identifier: MIT
#include "core/pace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/refused.hpp"

namespace tactor::detail {
namespace {

/// Solves g(u) = way by Newton's method, from a u at or above the solution. g is convex and rises from 0 to
/// 0.5 on [0, 0.5], so each step goes down.
template <typename G, typename Slope>
double solve_newton(double u, double way, G g, Slope slope) noexcept
{
    for (int i = 0; i < 64; ++i) {
        const double next = u - (g(u) - way) / slope(u);
        if (!(next < u))
            break;
        u = next;
    }
    return u;
}

double invert_half_easing(easing_kind k, double way) noexcept
{
    if (k == easing_kind::in_out)
        return solve_newton(
            std::min(0.5, std::sqrt(way / 2.0)), way, [](double u) { return u * u * (3.0 - 2.0 * u); },
            [](double u) { return 6.0 * u * (1.0 - u); });
    return solve_newton(
        std::min(0.5, std::cbrt(way / 4.0)), way,
        [](double u) { return u * u * u * (10.0 + u * (6.0 * u - 15.0)); },
        [](double u) { return 30.0 * u * u * (1.0 - u) * (1.0 - u); });
}

/// Returns the part of the length that is covered after a part u of the time (0 to 1). The function
/// invert_easing() is its inverse, except for rounding.
double apply_easing(easing_kind k, double u) noexcept
{
    if (!(u > 0.0))
        return 0.0;
    if (u >= 1.0)
        return 1.0;
    switch (k) {
    case easing_kind::in_out:
        return u * u * (3.0 - 2.0 * u);
    case easing_kind::minimum_jerk:
        return u * u * u * (10.0 + u * (6.0 * u - 15.0));
    case easing_kind::linear:
        break;
    }
    return u;
}

double invert_easing(easing_kind k, double way) noexcept
{
    if (!(way > 0.0))
        return 0.0;
    if (way >= 1.0)
        return 1.0;
    if (k == easing_kind::linear)
        return way;
    return way <= 0.5 ? invert_half_easing(k, way) : 1.0 - invert_half_easing(k, 1.0 - way);
}

/// Returns log(1 + x) / x; the next function returns (exp(x) - 1) / x. Both are 1 at 0.
double log1p_over_x(double x) noexcept
{
    return x == 0.0 ? 1.0 : std::log1p(x) / x;
}

double expm1_over_x(double x) noexcept
{
    return x == 0.0 ? 1.0 : std::expm1(x) / x;
}

/// Returns the speeds. Adds a point at an end of the path that has none.
std::vector<profile_point> whole(std::vector<profile_point> speeds)
{
    if (speeds.empty())
        return {{0.0, 1.0}, {1.0, 1.0}};
    if (speeds.front().part > 0.0)
        speeds.insert(speeds.begin(), {0.0, speeds.front().value});
    if (speeds.back().part < 1.0)
        speeds.push_back({1.0, speeds.back().value});
    return speeds;
}

std::vector<profile_point>::const_iterator find_first_after(const std::vector<profile_point>& points,
                                                            double part) noexcept
{
    return std::upper_bound(points.begin(), points.end(), part,
                            [](double v, const profile_point& p) noexcept { return v < p.part; });
}

/// Refuses a profile unless its parts are in ascending order within 0 to 1 and its values are within
/// `allowed`.
void check_profile_points(std::string_view what, const std::vector<profile_point>& points,
                          const bounds& allowed)
{
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto refuse = [&](std::string_view why, std::string_view hint) {
            throw bad_field(what, fmt::format("point {}: {}", i + 1, why), hint);
        };
        const auto [part, value] = points[i];
        if (!bounds_of::part.holds(part))
            refuse(fmt::format("part {} is out of range", part), "give 0, the path's start, to 1, its end");
        if (i > 0 && !(part > points[i - 1].part))
            refuse(fmt::format("part {} is not after the previous one, {}", part, points[i - 1].part),
                   "put parts in ascending order");
        if (!allowed.holds(value))
            refuse(fmt::format("{} is out of range", value),
                   allowed.above_low
                       ? fmt::format("give more than {:g} and at most {:g}", allowed.low, allowed.high)
                       : fmt::format("give {:g} to {:g}", allowed.low, allowed.high));
    }
}

/// Returns the value at a part by linear interpolation, or 1 if there are no points. O(log n).
double interpolate_profile(const std::vector<profile_point>& points, double part) noexcept
{
    if (points.empty())
        return 1.0;
    const auto after = find_first_after(points, part);
    if (after == points.begin())
        return points.front().value;
    const profile_point& a = *(after - 1);
    if (after == points.end() || a.part == part)
        return a.value;
    return a.value + (part - a.part) / (after->part - a.part) * (after->value - a.value);
}

/// Returns the greatest value of a profile between two parts.
double max_profile_value(const std::vector<profile_point>& points, double from, double to) noexcept
{
    double most = std::max(interpolate_profile(points, from), interpolate_profile(points, to));
    for (auto p = find_first_after(points, from); p != points.end() && p->part < to; ++p)
        most = std::max(most, p->value);
    return most;
}

} // namespace

double travel_time_s(const movement& m, double length_mm)
{
    const std::vector<profile_point> speeds = whole(m.speed_mm_s);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < speeds.size(); ++i) {
        const double v = speeds[i].value;
        sum += (speeds[i + 1].part - speeds[i].part) / v * log1p_over_x((speeds[i + 1].value - v) / v);
    }
    return sum * length_mm;
}

void check_movement(const movement& m)
{
    check_profile_points("speed_mm_s", m.speed_mm_s, {least_speed_mm_s, max_mm});
    check_profile_points("intensity", m.intensity, {0.0, max_intensity});
    std::vector<profile_point> times;
    for (const rest& r : m.rests)
        times.push_back({r.part, r.time_s});
    check_profile_points("pauses", times, {0.0, longest_stroke_s, true});
    for (const rest& r : m.rests)
        if (!bounds_of::part.holds(r.intensity))
            throw bad_field("pauses", fmt::format("intensity {:g} is out of range", r.intensity),
                            "give a factor from 0 to 1");
}

pace::pace(movement m, double moving_s) : definition_(std::move(m)), moving_s_(moving_s)
{
    build_stretches();
    build_phases();
}

void pace::build_stretches()
{
    const std::vector<profile_point> speeds = whole(definition_.speed_mm_s);
    const double scale = moving_s_ / travel_time_s(definition_, 1.0);
    double begin = 0.0;
    for (std::size_t i = 0; i + 1 < speeds.size(); ++i) {
        const double v = speeds[i].value;
        const double width = speeds[i + 1].part - speeds[i].part;
        stretch s{speeds[i].part, width, (speeds[i + 1].value - v) / v, begin, scale * width / v};
        begin += s.unit_s * log1p_over_x(s.change);
        stretches_.push_back(s);
    }
}

void pace::build_phases()
{
    double part = 0.0;
    double moved = 0.0;
    const auto move_to = [&](double to, double until) {
        if (!(to > part))
            return;
        phases_.push_back({total_s_, total_s_ + (until - moved), part, to, moved, until, 1.0});
        total_s_ = phases_.back().end_s;
        part = to;
        moved = until;
    };
    for (const rest& r : definition_.rests) {
        move_to(r.part, r.part < 1.0 ? find_moving_time_s(r.part) : moving_s_);
        phases_.push_back({total_s_, total_s_ + r.time_s, part, part, moved, moved, r.intensity});
        total_s_ = phases_.back().end_s;
    }
    move_to(1.0, moving_s_);
}

double pace::find_part_after(double moving_s) const noexcept
{
    const auto after = std::upper_bound(stretches_.begin(), stretches_.end(), moving_s,
                                        [](double v, const stretch& s) noexcept { return v < s.begin_s; });
    const stretch& s = after == stretches_.begin() ? stretches_.front() : *(after - 1);
    const double z = (moving_s - s.begin_s) / s.unit_s;
    return s.part + s.width * std::min(1.0, z * expm1_over_x(s.change * z));
}

double pace::find_moving_time_s(double part) const noexcept
{
    const auto after = std::upper_bound(stretches_.begin(), stretches_.end(), part,
                                        [](double v, const stretch& s) noexcept { return v < s.part; });
    const stretch& s = after == stretches_.begin() ? stretches_.front() : *(after - 1);
    const double q = std::min(1.0, (part - s.part) / s.width);
    return s.begin_s + s.unit_s * q * log1p_over_x(s.change * q);
}

const pace::phase& pace::at(double t_s) const noexcept
{
    const auto after = std::upper_bound(phases_.begin(), phases_.end(), t_s,
                                        [](double v, const phase& p) noexcept { return v < p.begin_s; });
    // NaN gives the first phase: all functions of time treat NaN as the start.
    return after == phases_.begin() || !(t_s > 0.0) ? phases_.front() : *(after - 1);
}

double pace::find_part_in_phase(const phase& p, double t_s) const noexcept
{
    if (p.rests() || !(t_s > p.begin_s))
        return p.from;
    if (t_s >= p.end_s)
        return p.to;
    const double u = (t_s - p.begin_s) / (p.end_s - p.begin_s);
    const double moved =
        p.begin_moving_s + apply_easing(definition_.easing, u) * (p.end_moving_s - p.begin_moving_s);
    return std::clamp(find_part_after(moved), p.from, p.to);
}

double pace::part(double t_s) const noexcept
{
    return find_part_in_phase(at(t_s), t_s);
}

double pace::intensity(double t_s) const noexcept
{
    const phase& p = at(t_s);
    return p.intensity * interpolate_profile(definition_.intensity, find_part_in_phase(p, t_s));
}

double pace::arrival_s(double part) const noexcept
{
    const auto found = std::lower_bound(phases_.begin(), phases_.end(), part,
                                        [](const phase& p, double v) noexcept { return p.to < v; });
    const phase& p = found == phases_.end() ? phases_.back() : *found;
    if (p.rests() || !(part > p.from))
        return p.begin_s;
    if (part >= p.to)
        return p.end_s;
    const double way = (find_moving_time_s(part) - p.begin_moving_s) / (p.end_moving_s - p.begin_moving_s);
    return std::min(p.begin_s + invert_easing(definition_.easing, way) * (p.end_s - p.begin_s), p.end_s);
}

std::vector<double> pace::bends() const
{
    std::vector<double> times;
    auto next = stretches_.begin();
    for (const phase& p : phases_) {
        times.push_back(p.begin_s);
        for (; next != stretches_.end() && next->part < p.to; ++next)
            if (next->part > p.from)
                times.push_back(arrival_s(next->part));
    }
    times.push_back(total_s_);
    return times;
}

double pace::intensity_bound(double from_part, double to_part) const noexcept
{
    return max_profile_value(definition_.intensity, from_part, to_part);
}

} // namespace tactor::detail
