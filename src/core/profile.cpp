// SPDX-License-Identifier: MIT
#include "core/profile.hpp"
#include "core/refused.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::detail {
namespace {

std::vector<profile_point>::const_iterator first_after(const std::vector<profile_point>& points,
                                                       double part) noexcept
{
    return std::upper_bound(points.begin(), points.end(), part,
                            [](double v, const profile_point& p) noexcept { return v < p.part; });
}

} // namespace

void check_profile_points(std::string_view what, const std::vector<profile_point>& points, double low,
                          double high, bool above_low)
{
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto refuse = [&](std::string_view why, std::string_view hint) {
            throw detail::bad_field(what, fmt::format("point {}: {}", i + 1, why), hint);
        };
        const auto [part, value] = points[i];
        if (!(part >= 0.0 && part <= 1.0))
            refuse(fmt::format("part {}", part), "0 is the path's start, 1 its end");
        if (i > 0 && !(part > points[i - 1].part))
            refuse(fmt::format("part {} does not come after {}", part, points[i - 1].part), "parts ascend");
        if (!(value <= high && (above_low ? value > low : value >= low)))
            refuse(fmt::format("{}", value),
                   above_low ? fmt::format("it is more than {:g} and at most {:g}", low, high)
                             : fmt::format("it is from {:g} to {:g}", low, high));
    }
}

double profile_at(const std::vector<profile_point>& points, double part) noexcept
{
    if (points.empty())
        return 1.0;
    const auto after = first_after(points, part);
    if (after == points.begin())
        return points.front().value;
    const profile_point& a = *(after - 1);
    if (after == points.end() || a.part == part)
        return a.value;
    return a.value + (part - a.part) / (after->part - a.part) * (after->value - a.value);
}

double greatest_between(const std::vector<profile_point>& points, double from, double to) noexcept
{
    double most = std::max(profile_at(points, from), profile_at(points, to));
    for (auto p = first_after(points, from); p != points.end() && p->part < to; ++p)
        most = std::max(most, p->value);
    return most;
}

} // namespace tactor::detail
