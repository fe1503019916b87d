// SPDX-License-Identifier: MIT
/// \file
/// The bars, curves and conflicts of the timing diagram.
#pragma once

#include <string>
#include <vector>

#include "plot/draw/lanes.hpp"
#include "plot/draw/timeline.hpp"

namespace tactor::plot {

/// Where the rows of the timing diagram are.
struct timing_frame {
    lanes rows = {};
    scale x = {};
    double top = 0.0;  ///< of the first row, pt
    double peak = 1.0; ///< largest amplitude

    /// Level of each stroke in each row, by row and stroke; empty: all have one.
    std::vector<std::vector<std::size_t>> levels = {};

    double base_of(std::size_t row, std::size_t stroke) const noexcept
    {
        const lane& r = rows.rows[row];
        const std::size_t level = levels.empty() ? 0 : levels[row][stroke];
        const double over = r.height - rows.height * static_cast<double>(r.levels);
        return top + r.top + over + static_cast<double>(level + 1) * rows.height;
    }
    double bottom_of(std::size_t row) const noexcept
    {
        return top + rows.rows[row].top + rows.rows[row].height;
    }
    double bar_height(double amplitude) const noexcept { return 0.86 * rows.height * amplitude / peak; }
};

/// Strokes that play at one time on one tactor get levels of their own in its row, one below the other, as
/// far as `space` pt allow for all rows. Returns what they do not, in words; empty: they do.
std::string part_strokes(timing_frame& f, const timeline& t, double space);

/// Whether there are too many bars, or too narrow ones, to draw one by one.
bool too_dense(const timeline& t, const timing_frame& f);

/// A bar for each tactor of each burst; they show through each other where some overlap in a row.
void draw_bars(canvas& c, const timeline& t, const timing_frame& f);

/// The largest amplitude of each row over time: of `continuous`, and of what is too dense.
void draw_columns(canvas& c, const scene& s, const timeline& t, const timing_frame& f);

/// Hatches the times in which one tactor serves two bursts. Whether there are any.
bool draw_conflicts(canvas& c, const scene& s, const timeline& t, const timing_frame& f);

} // namespace tactor::plot
