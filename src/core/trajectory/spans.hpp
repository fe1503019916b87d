// SPDX-License-Identifier: MIT
// A trajectory in the pieces between which something changes, so that bounds can be computed, not sampled;
// and how far along its path the target is at which time.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// A stretch of time in which the target moves along one straight line, or along one curve.
struct trajectory_span {
    double from_s = 0.0;
    double to_s = 0.0;
    double intensity = 0.0;                            ///< the greatest
    const shape* curve = nullptr;                      ///< none: a straight line, or a rest
    std::function<double(double parameter)> time_at{}; ///< of a curve: when it is at a parameter of it
};

/// Calls `visit` for each, in order of time and without gaps from 0 to the duration, until it gives false.
void for_each_span(const trajectory& t, const std::function<bool(const trajectory_span&)>& visit);

/// The part of the path, 0 to 1 by its length, that lies behind the target at a time.
struct way_point {
    double t_s = 0.0;
    double part = 0.0;
};

/// Returns the way from time 0 to the duration, times strictly ascending; linear between the points. Where
/// easing or a change of speed bends it, the points are so near to each other that they are off by at most
/// 1e-4 of what lies between two rests or changes. `part` of a target that never moves is 0.
std::vector<way_point> way_over_time(const trajectory& t);

/// A way that is smooth from one point to the next.
struct smooth_way {
    std::vector<way_point> points; ///< from 0 to the duration, times strictly ascending
    /// The part that lies behind the target at a part of the time, 0 to 1, from a point to the next. Valid
    /// while the trajectory lives.
    std::function<double(std::size_t point, double u)> part;
};

/// Returns the way with a point where the target comes to each of `at`, parts of the path, ascending.
smooth_way find_smooth_way(const trajectory& t, std::span<const double> at);

} // namespace tactor::detail
