// SPDX-License-Identifier: MIT
/// \file
/// Where the bursts are felt: the array, the path, the phantoms and their tactors (as figure 3 of Park et al.
/// 2016).
#pragma once

#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Bursts that are drawn at most; of more, and where they would lie on each other, every n-th is.
inline constexpr std::size_t most_shown_bursts = 120;

inline constexpr std::size_t most_array_notes = 6; ///< lines

/// Draws into the upper part of a box; returns the height taken. Where tactors would be too close for their
/// numbers it is higher than the box, but at most `highest` pt and most_array_notes lines.
double draw_array_view(canvas& c, const scene& s, const timeline& t, box at_most, double highest);

} // namespace tactor::plot
