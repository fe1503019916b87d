// SPDX-License-Identifier: MIT
// A trajectory in pieces between its changes, so that bounds can be computed instead of sampled; the target's
// position along its path over time; and timed points, for files and programs that know nothing else.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// A stretch of time in which the target moves along one straight line or one curve.
struct trajectory_span {
    double from_s = 0.0;
    double to_s = 0.0;
    double intensity = 0.0;       ///< the greatest in the stretch
    const shape* curve = nullptr; ///< null: a straight line, or a rest
    /// Curves: time at which the target reaches `parameter`, s.
    std::function<double(double parameter)> time_at{};
};

/// Calls `visit` for each span, in order of time and without gaps from 0 to the duration. Stops when it
/// returns false.
void for_each_span(const trajectory& t, const std::function<bool(const trajectory_span&)>& visit);

/// Part of the path, 0 to 1 by length, that the target has covered at a time.
struct progress_point {
    double t_s = 0.0;
    double part = 0.0;
};

/// Returns the covered part from time 0 to the duration, times strictly ascending; linear between the points.
/// If the speed changes, points are so dense that the error is at most 1e-4 of the change between two rests
/// or changes. For a target that never moves, `part` is 0.
std::vector<progress_point> progress_over_time(const trajectory& t);

/// Covered part over time, smooth from one point to the next.
struct smooth_progress {
    std::vector<progress_point> points; ///< from 0 to the duration, times strictly ascending
    /// Returns the covered part at a fraction u of the time (0 to 1) from a point to the next. Valid while
    /// the trajectory lives.
    std::function<double(std::size_t point, double u)> part;
};

/// Returns the covered part of the path over time, with a point at each time when the target reaches one of
/// `at`, which ascend.
smooth_progress find_smooth_progress(const trajectory& t, std::span<const double> at);

/// Returns points between which the target moves linearly: its own, if it has timed points; else so many that
/// no place is off by more than 0.01 mm and no time by more than 0.1 ms.
/// \throws error (bad_input) for more than a million points.
std::vector<timed_point> sample_points(const trajectory& t);

} // namespace tactor::detail
