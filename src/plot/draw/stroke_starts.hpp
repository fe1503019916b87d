// SPDX-License-Identifier: MIT
/// \file
/// Starts of several strokes over a diagram in time, and the legend of their colours.
#pragma once

#include <string>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Height that draw_stroke_starts() needs over the diagram, pt; 0 for one stroke.
double starts_height(const timeline& t);

/// Draws a line at the start of each of several strokes, from over the diagram's top to its bottom, with the
/// numbers of all that start there. Returns a note on starts without space; empty: none.
std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom);

/// Draws, for a scene of several strokes, the number, colour and name of each, repeats together, in columns
/// from the upper edge of a box. Returns the height taken; 0 for one stroke. `colours`: the picture has
/// colours of strokes.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
