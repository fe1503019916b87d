// SPDX-License-Identifier: MIT
/// \file
/// Bars with error bars in panels, as figures 8 and 9 of Park et al. 2016.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// A bar; a gap if it has no height.
struct bar {
    std::optional<double> height = {};
    std::optional<double> error = {}; ///< half the length of the error bar
    std::vector<double> values = {};  ///< values with the height as their mean: a dot each
};

/// Bars of one look: a bar in each group.
struct bar_series {
    std::string name = {}; ///< empty: not in the legend
    std::vector<bar> bars = {};
};

struct bar_panel {
    std::string title = {};
    std::string y_title = {};
    double y_from = 0.0;
    double y_to = 1.0;                ///< above y_from; bars end here
    std::optional<double> level = {}; ///< a dashed line, such as chance
    std::vector<std::string> groups = {};
    std::vector<bar_series> series = {}; ///< each has as many bars as there are groups
};

struct bar_figure {
    std::string title = {};
    bool heading = true; ///< true: the title is above the picture
    double width_mm = 170.0;
    std::string note = {};   ///< under the picture
    std::string across = {}; ///< text across each panel, such as "simulated"
    std::vector<bar_panel> panels = {};
};

/// Draws the panels, two beside each other from 120 mm width on. Each panel is an SVG group of kind "bars"
/// with data-title, data-y0 and data-y-scale: page = y0 + scale * value; each bar is of kind "bar", its error
/// bar of kind "error", a dot of kind "value".
canvas draw_bar_figure(const bar_figure& f);

} // namespace tactor::plot
