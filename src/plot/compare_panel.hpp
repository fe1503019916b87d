// SPDX-License-Identifier: MIT
/// \file
/// One panel of a comparison: the target and what is felt instead, on the array.
#pragma once

#include "plot/compare_figure.hpp"
#include "plot/draw/array_frame.hpp"

namespace tactor::plot {

/// What all panels show.
struct panel_ground {
    const array& tactors;
    const stroke& target;
    extent shown;
};

/// Where the array is in a panel; the scale is the same in all of one size.
array_frame panel_frame(const panel_ground& g, box where);

/// The target's line, in panels and charts alike.
inline constexpr style target_look{.stroke = light_grey, .width = 2.6};

/// A text in small lines, as many as it takes and no more than that; returns the height taken.
double draw_words(canvas& c, const std::string& text, box where, std::size_t most_lines, const char* kind);

/// Draws into the upper part of a box, in the look of its algorithm; returns the height taken.
double draw_panel(canvas& c, const panel_ground& g, const prediction& p, const style& look, box where);

} // namespace tactor::plot
