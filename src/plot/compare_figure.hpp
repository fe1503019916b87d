// SPDX-License-Identifier: MIT
/// \file
/// Predicted percepts of several algorithms (as figure 6 of Park et al. 2016), and their speeds.
#pragma once

#include <string>

#include <tactor/array.hpp>

#include "percept/compare.hpp"
#include "plot/draw/array_frame.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Draws for each phantom model a row of panels, one for each algorithm, and under it their speeds over time.
/// Rows need their samples. `title` is above the picture, with the target's length and time; empty: neither.
/// \throws error (bad_input) for a width out of bounds (figure.hpp).
canvas draw_comparison(const array& a, const detail::comparison& all, const std::string& title,
                       double width_mm);

/// The array, target and part of the page that all panels show.
struct panel_ground {
    const array& tactors;
    const stroke& target;
    extent shown;
};

/// Returns the place of the array in a panel; the scale is the same in all panels of one size.
array_frame panel_frame(const panel_ground& g, box where);

/// Look of the target's line, in panels and charts.
inline constexpr style target_look{.stroke = light_grey, .width = 2.6};

/// Draws a text in at most `most_lines` small lines; returns the height taken.
double draw_words(canvas& c, const std::string& text, box where, std::size_t most_lines, const char* kind);

/// Draws a panel into the upper part of a box: the target, and the predicted percept in the look of its
/// algorithm. Returns the height taken.
double draw_panel(canvas& c, const panel_ground& g, const detail::comparison_row& p, const style& look,
                  box where);

} // namespace tactor::plot
