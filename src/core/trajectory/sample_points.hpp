// SPDX-License-Identifier: MIT
/// \file
/// Trajectories as timed points, for files and programs that know nothing else.
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Most points of a sampled trajectory.
inline constexpr std::size_t most_sampled_points = 1'000'000;

/// Returns points between which the target moves linearly: its own, if it has timed points; else so many that
/// no place is off by more than 0.01 mm and no time by more than 0.1 ms.
/// \throws error (bad_input) for more than most_sampled_points.
std::vector<timed_point> sample_points(const trajectory& t);

} // namespace tactor::detail
