// SPDX-License-Identifier: MIT
/// \file
/// The whole picture.
#pragma once

#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

enum class figure_view { array, timing, wave, both };

struct figure_options {
    figure_view view = figure_view::both;
    double width_mm = 85.0; ///< one print column
    bool heading = true;    ///< the name and the facts above the picture
};

inline constexpr double least_width_mm = 60.0;
inline constexpr double most_width_mm = 1000.0;

/// Draws a scene. The height follows from the content; it is at most 247 mm, or of a picture wider than 170
/// mm in that proportion to it. \throws error (bad_input), for the waveform, see draw_wave_view().
canvas draw_figure(const scene& s, const figure_options& o);

} // namespace tactor::plot
