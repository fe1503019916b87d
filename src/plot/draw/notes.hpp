// SPDX-License-Identifier: MIT
/// \file
/// Headings over a picture, and notes under it, which name what has no space.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

inline constexpr double note_height = 8.0; ///< of a line, pt

/// Returns the parts that are not empty, with a separator between them.
std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Draws a text in at most `most_lines` small lines, from the upper edge of a box down. Returns the height
/// taken.
double draw_words(canvas& c, std::string_view text, box where, std::size_t most_lines, const char* kind);

/// Draws the notes that are not empty in the same way.
double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines);

/// Draws a title and a text under it, from the upper edge of a box down. Returns the height taken.
double draw_heading(canvas& c, const std::string& title, std::string_view text, box where);

} // namespace tactor::plot
