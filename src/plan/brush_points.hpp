// SPDX-License-Identifier: MIT
/// \file
/// Virtual tactors of the Tactile Brush: where a stroke meets the lines of a grid.
#pragma once

#include <vector>

#include "plan/job.hpp"

namespace tactor::detail {

/// The start, every crossing with a grid line and the end, in path order, each place once where the
/// target does not leave it in between; start and end are never joined. At least two.
/// \throws error (bad_input) when the path leaves the array, or starts or ends off the grid's lines.
std::vector<meeting> virtual_tactors(const job& j, const grid_lines& grid);

} // namespace tactor::detail
