// SPDX-License-Identifier: MIT
/// \file
/// Whether a movement stays in the array, at all times.
#pragma once

#include "plan/job.hpp"

namespace tactor::detail {

/// The hull is convex: what leaves it between two corners of the path does so on a curve, and is farthest
/// out where the curve turns, seen from an edge of the hull. So corners and turns are all that is looked at.
/// \throws error (bad_input) that says where the path leaves the array first.
void check_inside(const job& j);

} // namespace tactor::detail
