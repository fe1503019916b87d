// SPDX-License-Identifier: MIT
/// \file
/// Whether a movement stays in the array, at all times.
#pragma once

#include "plan/job.hpp"

namespace tactor::detail {

/// Looks only at the corners of the path and at the turns of its curves. This is enough, because the hull is
/// convex: between two corners only a curve can leave it, and it is farthest out where it turns, seen from an
/// edge of the hull.
/// \throws error (bad_input) that says where the path leaves the array first.
void check_inside(const job& j);

} // namespace tactor::detail
