// SPDX-License-Identifier: MIT
/// \file
/// One panel of a comparison: the target and what is felt instead, on the array.
#pragma once

#include "plot/array_frame.hpp"
#include "plot/compare_figure.hpp"

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

/// Draws into the upper part of a box, in the look of its algorithm; returns the height taken.
double draw_panel(canvas& c, const panel_ground& g, const prediction& p, const style& look, box where);

} // namespace tactor::plot
