// SPDX-License-Identifier: MIT
/// \file
/// Rows of a diagram over time, one for each tactor that plays; where there are very many, one for several.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "plot/draw/axes.hpp"

namespace tactor::plot {

struct lane {
    std::vector<unsigned> tactors = {};
    std::string label = {}; ///< "4", "4 (7)" where channels are other numbers, "100-103"
    std::size_t first = 0;  ///< level, counted through all rows
    std::size_t levels = 1; ///< strokes that play at one time on this row lie below each other
};

struct lanes {
    std::vector<lane> rows = {};
    std::vector<int> row_of = {}; ///< by tactor; -1: does not play
    double height = 10.0;         ///< of one level, pt
    std::string heading = {};     ///< over the labels
    double label_width = 0.0;     ///< pt

    std::size_t levels() const noexcept { return rows.empty() ? 0 : rows.back().first + rows.back().levels; }
    double all_height() const noexcept { return height * static_cast<double>(levels()); }
    double top_of(std::size_t row) const noexcept { return height * static_cast<double>(rows[row].first); }
    double height_of(std::size_t row) const noexcept
    {
        return height * static_cast<double>(rows[row].levels);
    }
    /// Gives the rows as many levels (by row) as asked for, and all a height with which they fit.
    void set_levels(const std::vector<std::size_t>& wished);
};

lanes make_lanes(const array& a, const std::vector<unsigned>& playing);

/// Labels end at x; as many rows get one as have room. `top`: of the first row.
void draw_lane_labels(canvas& c, const lanes& l, double x, double top);

/// Largest value in each column of the page, for one row: what remains of bars that are too many or too
/// narrow.
class column_profile {
public:
    explicit column_profile(const scale& x);
    /// Notes a value from one time to another.
    void add(double from_s, double to_s, double value);
    /// The outline of what is above 0, as closed shapes over `base` (the y of 0), `height` pt for 1. Steps
    /// are kept: or, with `smooth`, column centres are joined.
    std::vector<std::vector<spot>> outlines(double base, double height, bool smooth) const;

private:
    scale x_;
    std::vector<double> columns_;
};

inline constexpr double column_width = 0.4; ///< pt

} // namespace tactor::plot
