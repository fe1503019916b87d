// SPDX-License-Identifier: MIT
/// \file
/// Text in pictures: its largest width, and shortening.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tactor::plot {

/// The typeface of all pictures, in every format.
inline constexpr const char* typeface = "DejaVu Sans";

/// Returns the width in pt, from a table of that typeface: layout must not depend on the fonts of a machine.
double text_width(std::string_view utf8, double size, bool bold = false) noexcept;

/// Sizes in every figure, pt.
inline constexpr double margin = 5.0;
inline constexpr double title_size = 8.0;

/// Returns the height of digits and capitals, pt.
constexpr double cap_height(double size) noexcept
{
    return 0.73 * size;
}

/// Returns valid UTF-8 without control characters: U+FFFD replaces bytes that XML or Cairo refuse.
std::string clean(std::string_view text);

/// Returns the text, or its beginning and an ellipsis if it is wider than `width` pt.
std::string shorten(std::string_view text, double size, double width, bool bold = false);

/// Returns lines of at most `width` pt, broken between words. Shortens the last of `most_lines`, and words
/// that are wider.
std::vector<std::string> wrap(std::string_view text, double size, double width, std::size_t most_lines);

/// Formats a number with at most `digits` significant digits and no trailing zeros, the same in every locale.
std::string number(double v, int digits = 4);

} // namespace tactor::plot
