// SPDX-License-Identifier: MIT
// A value over the part of a path, linear between points.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Checks a profile.
/// \throws error (bad_input), about `what`, unless parts ascend within 0 to 1 and values are within low ...
///         high; `above_low` excludes low itself.
void check_profile_points(std::string_view what, const std::vector<profile_point>& points, double low,
                          double high, bool above_low);

/// Returns the value at a part; 1 without points. O(log n).
double profile_at(const std::vector<profile_point>& points, double part) noexcept;

/// Returns the greatest value between two parts. O(log n + points between them).
double greatest_between(const std::vector<profile_point>& points, double from, double to) noexcept;

/// Returns points by part of the path, in the order from its other end.
template <class Point>
std::vector<Point> from_the_end(std::vector<Point> points)
{
    std::reverse(points.begin(), points.end());
    for (Point& p : points)
        p.part = 1.0 - p.part;
    return points;
}

} // namespace tactor::detail
