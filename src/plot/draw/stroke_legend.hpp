// SPDX-License-Identifier: MIT
/// \file
/// Which colour is which stroke, and when each starts.
#pragma once

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// For a scene of several strokes the number, colour and name of each, in columns from the upper edge of a
/// box. Returns the height taken; 0 for one stroke. `colours`: whether the picture has these.
double draw_stroke_legend(canvas& c, const scene& s, box where, bool colours);

/// Room over a diagram for the numbers of strokes, pt; 0 for one stroke, and for so many that they say
/// nothing.
double starts_height(const timeline& t) noexcept;

/// A line at each start, from over the diagram's top to its bottom, with the numbers of the strokes that
/// start there. Nothing where they have no height.
void draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom);

} // namespace tactor::plot
