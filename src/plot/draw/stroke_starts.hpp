// SPDX-License-Identifier: MIT
/// \file
/// When each of several strokes starts, over a diagram in time, and which colour is which stroke.
#pragma once

#include <string>
#include <vector>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// The starts of a scene's strokes and where their numbers stand.
struct stroke_starts {
    struct start {
        double at = 0.0;        ///< x, pt
        std::string label = {}; ///< of all strokes that start there; empty: no space
        std::size_t line = 0;   ///< of the numbers, from the lowest: they stand over each other where they
                                ///< are too close to stand beside each other
    };

    std::vector<start> marks = {};
    double height = 0.0;   ///< that they need over the diagram, pt; 0 for one stroke
    std::string note = {}; ///< what had no space
};

stroke_starts look_at_starts(const timeline& t, const scale& x);

/// Draws a line at each start, from over the diagram's top to its bottom.
void draw_stroke_starts(canvas& c, const stroke_starts& s, double top, double bottom);

/// Writes the numbers of the strokes at their starts, over whatever lies there.
void number_stroke_starts(canvas& c, const stroke_starts& s, double top);

/// Returns ascending numbers as text, "1-4, 6": those that follow each other together.
std::string join_runs(const std::vector<std::size_t>& numbers);

/// Draws, for a scene of several strokes, the number, colour and name of each, repeats of one together, in
/// columns from the upper edge of a box. Returns the height taken; 0 for one stroke. `colours`: whether the
/// picture has these.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
