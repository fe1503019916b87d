// SPDX-License-Identifier: MIT
/// \file
/// Starts of several strokes over a diagram in time, and the legend of their colours.
#pragma once

#include <string>
#include <vector>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Starts of a scene's strokes and the places of their numbers.
struct stroke_starts {
    struct start {
        double at = 0.0;        ///< x, pt
        std::string label = {}; ///< numbers of all strokes that start there; empty: no space
        std::size_t line = 0;   ///< of the number, from the lowest: close numbers are above each other
    };

    std::vector<start> marks = {};
    double height = 0.0;   ///< needed over the diagram, pt; 0 for one stroke
    std::string note = {}; ///< on starts without space
};

stroke_starts find_starts(const timeline& t, const scale& x);

/// Draws a line at each start, from over the diagram's top to its bottom.
void draw_stroke_starts(canvas& c, const stroke_starts& s, double top, double bottom);

/// Writes the numbers of the strokes at their starts, on top of the drawing.
void number_stroke_starts(canvas& c, const stroke_starts& s, double top);

/// Returns ascending numbers as text, "1-4, 6": consecutive ones together.
std::string join_runs(const std::vector<std::size_t>& numbers);

/// Draws, for a scene of several strokes, the number, colour and name of each, repeats together, in columns
/// from the upper edge of a box. Returns the height taken; 0 for one stroke. `colours`: the picture has
/// colours of strokes.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
