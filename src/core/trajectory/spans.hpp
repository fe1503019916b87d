// SPDX-License-Identifier: MIT
// Three views of a trajectory: spans between its changes, from which bounds are computed without sampling;
// the target's position along its path over time; and timed points, for files and programs that support
// nothing else.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// A time span in which the target moves along one straight line or one curve.
struct trajectory_span {
    double from_s = 0.0;
    double to_s = 0.0;
    double intensity = 0.0;       ///< greatest intensity in the span
    const shape* curve = nullptr; ///< null for a straight line or a rest
    /// Time at which the target reaches `parameter` of the curve, s. Set only for curves.
    std::function<double(double parameter)> time_at{};
};

/// Calls `visit` for each span, in order of time and without gaps from 0 to the duration. Stops when `visit`
/// returns false.
void for_each_span(const trajectory& t, const std::function<bool(const trajectory_span&)>& visit);

/// Part of the path that the target has covered at a time, 0 to 1 by length.
struct progress_point {
    double t_s = 0.0;
    double part = 0.0;
};

/// Returns the covered part from time 0 to the duration, with strictly ascending times. Between the points
/// the covered part is linear. Where the speed changes, the points are so close that the error is at most
/// 1e-4 of the change between two rests or changes. For a target that never moves, `part` is 0.
std::vector<progress_point> progress_over_time(const trajectory& t);

/// Covered part of the path over time, as a smooth function between points.
struct smooth_progress {
    std::vector<progress_point> points; ///< points from time 0 to the duration, times strictly ascending
    /// Returns the covered part at a fraction u (0 to 1) of the time between a point and the next. Valid
    /// while the trajectory exists.
    std::function<double(std::size_t point, double u)> part;
};

/// Returns the covered part of the path over time, with a point at each time at which the target reaches an
/// element of `at`. Precondition: `at` ascends.
smooth_progress find_smooth_progress(const trajectory& t, std::span<const double> at);

/// Returns points between which the target moves linearly. These are the trajectory's own timed points if it
/// has any. Otherwise there are enough points that no place is off by more than 0.01 mm and no time by more
/// than 0.1 ms.
/// \throws error (bad_input) for more than a million points.
std::vector<timed_point> sample_points(const trajectory& t);

} // namespace tactor::detail
