// SPDX-License-Identifier: MIT
/// \file
/// The closed form of the Tactile Brush schedule (rendering model, section 5; Israr and Poupyrev 2011).
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// The part of the next virtual tactor's burst that sounds before the target is there, s; negative
/// where the schedule is not possible. `gap_s`: time from this one to the next.
double next_part_s(const timing_profile& p, double gap_s, double part_s);

/// Parts before tau of all bursts, or nothing where the schedule is not possible. tau from 0, ascending.
std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s);

/// The shortest duration in which the same movement is possible: each part is linear in it.
double shortest_duration_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Virtual tactors are left out, the one with the smallest gap first, until the schedule is possible or only
/// both ends are left. Returns the places of those that are left, ascending. O(n log n).
std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s);

} // namespace tactor::detail
