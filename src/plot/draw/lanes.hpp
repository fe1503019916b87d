// SPDX-License-Identifier: MIT
/// \file
/// Rows of a diagram over time, one for each tactor that plays; one for several tactors if there are very
/// many.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "plot/draw/axes.hpp"

namespace tactor::plot {

struct lane {
    std::vector<unsigned> tactors = {};
    std::string label = {}; ///< "4", "4 (7)" if channels are other numbers, "100-103"
    std::size_t levels = 1; ///< rows of simultaneous strokes, one below the other
    double top = 0.0;       ///< under the top of the first, pt
    double height = 0.0;    ///< pt; its levels are at its bottom
};

struct lanes {
    std::vector<lane> rows = {};
    std::vector<int> row_by_tactor = {}; ///< -1: does not play
    double height = 0.0;                 ///< of one level, pt
    double all_height = 0.0;             ///< pt
    double label_pitch = 0.0;            ///< least distance of labels, pt
    std::string heading = {};            ///< above the labels
    double label_width = 0.0;            ///< pt

    /// Makes levels as high as possible in `space` pt. Returns true if each row then has space for its label.
    bool fit(double space);
    /// Makes each level this high, and no row lower than `least_row`, pt.
    void lay_out(double level, double least_row = 0.0);
};

/// Makes the rows of the playing tactors. `space`: for all rows, pt.
lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space);

/// Draws labels, which end at x, for as many rows as there is space. `top`: of the first row. Returns a note
/// on labels without space; empty: all have space.
std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top);

/// Largest value in each column of the page, for one row, instead of bars that are too many or too narrow.
class column_profile {
public:
    explicit column_profile(const scale& x);
    /// Notes a value from one time to another.
    void add(double from_s, double to_s, double value);
    /// Returns the outline of the values above 0, as closed shapes over `base` (the y of 0), `height` pt
    /// for 1. Keeps steps; with `smooth`, joins the centres of columns.
    std::vector<std::vector<spot>> outlines(double base, double height, bool smooth) const;

private:
    scale x_;
    std::vector<double> columns_;
};

inline constexpr double column_width = 0.4; ///< pt

} // namespace tactor::plot
