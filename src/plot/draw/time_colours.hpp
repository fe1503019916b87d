// SPDX-License-Identifier: MIT
/// \file
/// Colours that tell times, or strokes, apart.
#pragma once

#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// A strip of the colours of time, over x.
void draw_time_strip(canvas& c, const timeline& t, box where);

/// Colour of a burst: of its time in the piece where there is one stroke, of its stroke where there are
/// several.
colour colour_of(const timeline& t, const shown_burst& b) noexcept;

} // namespace tactor::plot
