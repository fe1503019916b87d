// SPDX-License-Identifier: MIT
// How far along its path a target is at which time.
#pragma once

#include <span>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// The part of the path, 0 to 1 by its length, that lies behind the target at a time.
struct way_point {
    double t_s = 0.0;
    double part = 0.0;
    double mean = 0.0; ///< of the part since the point before, to the last digits
};

/// From time 0 to the duration, times strictly ascending; linear between the points. Where easing or a change
/// of speed bends it, the points are so near to each other that they are off by at most 1e-4 of what lies
/// between two rests or changes. There is a point where the target comes to each of `at`, ascending. Of a
/// target that never moves, part is 0.
std::vector<way_point> way_over_time(const trajectory& t, std::span<const double> at = {});

} // namespace tactor::detail
