// SPDX-License-Identifier: MIT
/// \file
/// Diagrams over time: their rows, one for each tactor that plays or for several if there are very many; the
/// starts of strokes above them, and the legend of strokes.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

struct lane {
    std::vector<unsigned> tactors = {};
    std::string label = {}; ///< "4", "4 (7)" if channels are other numbers, "100-103"
};

inline constexpr double highest_level = 11.0; ///< pt

struct lanes {
    std::vector<lane> rows = {};
    std::vector<int> row_by_tactor = {}; ///< -1: does not play
    std::size_t levels = 1;              ///< of each row: one for each of simultaneous strokes
    double height = 0.0;                 ///< of one level, pt
    std::string heading = {};            ///< above the labels
    double label_width = 0.0;            ///< pt

    double row_height() const noexcept { return height * static_cast<double>(levels); }
    /// Returns the top of a row under that of the first, pt; of the row after the last, the height of all.
    double top(std::size_t row) const noexcept { return row_height() * static_cast<double>(row); }
    double all_height() const noexcept { return top(rows.size()); }

    /// Makes levels as high as possible in `space` pt, up to `highest` pt. Returns false if even the lowest
    /// take more.
    bool fit(double space, double highest = highest_level);
};

/// Makes the rows of the playing tactors. `space`: for all rows, pt.
lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space);

/// Draws labels, which end at x, for as many rows as there is space. `top`: of the first row. Returns a note
/// on labels without space; empty: all have space.
std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top);

/// Range of the values in a column of the page.
struct column_range {
    float low = 0.0F;
    float high = 0.0F;
};

/// Returns the outlines of adjoining columns that are not 0, as closed shapes. The edges of the columns are
/// at x(0), x(1), ...
std::vector<std::vector<spot>> outline(const std::vector<column_range>& columns, const scale& x,
                                       const scale& y);

inline constexpr double column_width = 0.4; ///< pt

/// Height that draw_stroke_starts() needs over the diagram, pt; 0 for one stroke.
double starts_height(const timeline& t);

/// Draws a line at the start of each of several strokes, from over the diagram's top to its bottom, with the
/// numbers of all that start there. Returns a note on starts without space; empty: none.
std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom);

/// Draws, for a scene of several strokes, the number, colour and name of each, repeats together, in columns
/// from the upper edge of a box. Returns the height taken; 0 for one stroke. `colours`: the picture has
/// colours of strokes.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
