// SPDX-License-Identifier: MIT
/// \file
/// What the tactors are driven with: the rendered samples.
#pragma once

#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Renders scene::sound and draws the envelope of each channel that is not silent, or the carrier itself
/// where there is space for its cycles. From (where.x, where.y) down, where.width wide; returns the height
/// taken. \throws error (bad_input) where the piece has too many samples to look at.
double draw_wave_view(canvas& c, const scene& s, const timeline& t, box where);

} // namespace tactor::plot
