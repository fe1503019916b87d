// SPDX-License-Identifier: MIT
// How far along its path a target is at which time.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// The part of the path, 0 to 1 by its length, that lies behind the target at a time.
struct way_point {
    double t_s = 0.0;
    double part = 0.0;
};

/// From time 0 to the duration, times strictly ascending; linear between the points. Where easing or a change
/// of speed bends it, the points are so near to each other that they are off by at most 1e-4 of what lies
/// between two rests or changes. Of a target that never moves, part is 0.
std::vector<way_point> way_over_time(const trajectory& t);

/// A way that is smooth from one point to the next.
struct smooth_way {
    std::vector<way_point> points; ///< from 0 to the duration, times strictly ascending
    /// The part that lies behind the target at a part of the time, 0 to 1, from a point to the next. Valid
    /// while the trajectory lives.
    std::function<double(std::size_t point, double u)> part;
};

/// There is a point where the target comes to each of `at`, parts of the path, ascending.
smooth_way find_smooth_way(const trajectory& t, std::span<const double> at);

} // namespace tactor::detail
