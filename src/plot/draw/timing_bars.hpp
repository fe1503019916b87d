// SPDX-License-Identifier: MIT
/// \file
/// The bars, curves and conflicts of the timing diagram.
#pragma once

#include <string>
#include <vector>

#include "plot/draw/lanes.hpp"
#include "plot/draw/timeline.hpp"

namespace tactor::plot {

/// Places of the rows of the timing diagram.
struct timing_frame {
    lanes rows = {};
    scale x = {};
    double top = 0.0;  ///< of the first row, pt
    double peak = 1.0; ///< largest amplitude

    /// Level of each stroke in each row, by row and stroke; empty: all have the same.
    std::vector<std::vector<std::size_t>> levels = {};

    double base_y(std::size_t row, std::size_t stroke) const noexcept
    {
        const lane& r = rows.rows[row];
        const std::size_t level = levels.empty() ? 0 : levels[row][stroke];
        const double over = r.height - rows.height * static_cast<double>(r.levels);
        return top + r.top + over + static_cast<double>(level + 1) * rows.height;
    }
    double bottom_y(std::size_t row) const noexcept
    {
        return top + rows.rows[row].top + rows.rows[row].height;
    }
    double bar_height(double amplitude) const noexcept { return 0.86 * rows.height * amplitude / peak; }
};

/// Gives simultaneous strokes on one tactor separate levels in its row, one below the other, if `space` pt
/// are enough for all rows. Returns a note if they are not; else empty.
std::string part_strokes(timing_frame& f, const timeline& t, double space);

/// Returns true if there are too many bars, or too narrow ones, to draw each.
bool too_dense(const timeline& t, const timing_frame& f);

/// Draws a bar for each tactor of each burst; bars are translucent if some overlap in a row.
void draw_bars(canvas& c, const timeline& t, const timing_frame& f);

/// Draws the largest amplitude of each row over time: for `continuous`, and for too many bars.
void draw_columns(canvas& c, const scene& s, const timeline& t, const timing_frame& f);

/// Hatches the times in which one tactor serves two bursts. Returns true if there are any.
bool draw_conflicts(canvas& c, const scene& s, const timeline& t, const timing_frame& f);

} // namespace tactor::plot
