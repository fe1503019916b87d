// SPDX-License-Identifier: MIT
/// \file
/// Who plays when, and how strongly: one row for each tactor (as figure 4 of Park et al. 2016).
#pragma once

#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Draws from (where.x, where.y) down, where.width wide; returns the height taken. With `colours` a strip
/// above the rows shows the colour of each time.
double draw_timing_view(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
