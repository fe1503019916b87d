// SPDX-License-Identifier: MIT
/// \file
/// The Tactile Brush (Israr and Poupyrev 2011): its virtual tactors, where a stroke meets the lines of a
/// grid, and the closed form of its schedule (rendering model, section 5).
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/plan.hpp>

#include "plan/job.hpp"

namespace tactor::detail {

/// Finds the start, every crossing with a grid line and the end, in path order, each place once where the
/// target does not leave it in between; start and end are never joined. At least two.
/// \throws error (bad_input) when the path leaves the array, or starts or ends off the grid's lines.
std::vector<meeting> virtual_tactors(const job& j, const grid_lines& grid);

/// Returns the part of the next virtual tactor's burst that sounds before the target is there, s; negative
/// where the schedule is not possible. `gap_s`: time from this one to the next.
double next_part_s(const timing_profile& p, double gap_s, double part_s);

/// Returns the parts before tau of all bursts, or nothing where the schedule is not possible. tau from 0,
/// ascending.
std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Returns the shortest duration in which the same movement is possible: each part is linear in it.
double shortest_duration_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Leaves virtual tactors out, the one with the smallest gap first, until the schedule is possible or only
/// both ends are left. Returns the places of those that are left, ascending. O(n log n).
std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s);

} // namespace tactor::detail
