// SPDX-License-Identifier: MIT
/// \file
/// Headings over a picture, and notes under it, which name what has no space.
#pragma once

#include <string>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Returns "tactor 3", "tactors 3, 12"; "9 tactors" for more than eight.
std::string tactors_text(const std::vector<unsigned>& tactors);

inline constexpr double note_height = 8.0; ///< of a line, pt

/// Returns the notes in lines of at most `width` pt, several in a line if they fit. Breaks wider notes
/// between words, shortens the last of `most_lines`, and skips empty notes.
std::vector<std::string> note_lines(const std::vector<std::string>& notes, double width,
                                    std::size_t most_lines);

/// Draws them from the upper edge of a box down; returns the height taken.
double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines);

/// Draws a title and lines under it, which must fit, from the upper edge of a box down. Returns the y of the
/// last baseline, pt.
double draw_heading(canvas& c, const std::string& title, const std::vector<std::string>& lines, box where);

} // namespace tactor::plot
