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

/// Draws into the upper part of a box; returns the height taken.
double draw_array_view(canvas& c, const scene& s, const timeline& t, box at_most);

/// A strip of the colours of time, over x.
void draw_time_strip(canvas& c, const timeline& t, box where);

/// Colour of a burst: of its time in the piece where there is one stroke, of its stroke where there are
/// several.
colour colour_of(const timeline& t, const shown_burst& b) noexcept;

} // namespace tactor::plot
