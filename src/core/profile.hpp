// SPDX-License-Identifier: MIT
// A value over the part of a path, linear between points.
#pragma once

#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// \throws error (bad_input), about `what`, unless parts ascend within 0 to 1 and values are within
///         low ... high, low itself being out with `above_low`.
void check_profile_points(std::string_view what, const std::vector<profile_point>& points, double low,
                          double high, bool above_low);

/// The value at a part; 1 without points. O(log n).
double profile_at(const std::vector<profile_point>& points, double part) noexcept;

/// The greatest value between two parts. O(log n + points between them).
double greatest_between(const std::vector<profile_point>& points, double from, double to) noexcept;

/// As seen from the other end.
std::vector<profile_point> from_the_end(const std::vector<profile_point>& points);
std::vector<carrier_part> from_the_end(const std::vector<carrier_part>& points);

} // namespace tactor::detail
