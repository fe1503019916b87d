// SPDX-License-Identifier: MIT
/// \file
/// Which colour is which stroke.
#pragma once

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// For a scene of several strokes the number, colour and name of each, repeats of one together, in columns
/// from the upper edge of a box. Returns the height taken; 0 for one stroke. `colours`: whether the picture
/// has these.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
