// SPDX-License-Identifier: MIT
/// \file
/// The Tactile Brush (Israr and Poupyrev 2011): its virtual tactors, where a stroke meets the lines of a
/// grid, and the closed form of its schedule (rendering model, section 5).
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// Returns the parts before tau of all bursts, or nothing where the schedule is not possible. tau from 0,
/// ascending.
std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s);

/// Leaves virtual tactors out, the one with the smallest gap first, until the schedule is possible or only
/// both ends are left. Returns the places of those that are left, ascending. O(n log n).
std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s);

} // namespace tactor::detail
