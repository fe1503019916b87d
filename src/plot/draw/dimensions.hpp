// SPDX-License-Identifier: MIT
/// \file
/// Dimension arrows, as on technical drawings, and hatching.
#pragma once

#include <string>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// An arrow from x0 to x1 at y with its label in or beside it; where the arrow would be too short its heads
/// point at the interval from outside. Thin lines run down to `below` at both ends.
void draw_dimension(canvas& c, double x0, double x1, double y, double below, const std::string& label,
                    const mark& m);

/// Slanted lines inside a box, and its rim.
void draw_hatch(canvas& c, box b, const mark& m);

} // namespace tactor::plot
