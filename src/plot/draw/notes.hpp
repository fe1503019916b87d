// SPDX-License-Identifier: MIT
/// \file
/// What of a picture had no space, in words under it.
#pragma once

#include <string>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// "tactor 3", "tactors 3, 12"; of more than eight, "9 tactors".
std::string tactors_text(const std::vector<unsigned>& tactors);

inline constexpr double note_height = 8.0; ///< of a line, pt

/// The notes in lines of at most `width` pt, several in a line where they fit; one wider than that is broken
/// between its words. The last of `most_lines` is shortened. Empty notes are none.
std::vector<std::string> note_lines(const std::vector<std::string>& notes, double width,
                                    std::size_t most_lines);

/// Draws them from the upper edge of a box down; returns the height taken.
double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines);

/// Draws a title and lines under it, which must fit, from the upper edge of a box down. Returns the y of the
/// last baseline, pt.
double draw_heading(canvas& c, const std::string& title, const std::vector<std::string>& lines, box where);

} // namespace tactor::plot
