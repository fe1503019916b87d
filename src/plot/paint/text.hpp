// SPDX-License-Identifier: MIT
/// \file
/// Text in pictures: how wide it is at most, and what of it fits.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tactor::plot {

/// The typeface of all pictures, in every format.
inline constexpr const char* typeface = "DejaVu Sans";

/// Width in pt, from a table of that typeface: layout must not depend on the fonts of one machine.
double text_width(std::string_view utf8, double size, bool bold = false) noexcept;

/// Of every figure, pt.
inline constexpr double margin = 5.0;
inline constexpr double title_size = 8.0;
inline constexpr double line_pitch = 8.0;

/// Height of digits and capitals, pt.
constexpr double cap_height(double size) noexcept
{
    return 0.73 * size;
}

/// Valid UTF-8 without control characters: what XML and Cairo refuse becomes U+FFFD.
std::string clean(std::string_view text);

/// The text, or its beginning and an ellipsis where it is wider than `width` pt.
std::string shorten(std::string_view text, double size, double width, bool bold = false);

/// The same with its end behind the ellipsis, for texts that begin alike.
std::string shorten_middle(std::string_view text, double size, double width);

/// Lines of at most `width` pt, broken after separators; the last of `max_lines` is shortened.
std::vector<std::string> wrap(const std::vector<std::string>& parts, std::string_view separator, double size,
                              double width, std::size_t max_lines);

/// At most `digits` significant digits, no trailing zeros, the same in every locale.
std::string number(double v, int digits = 4);

} // namespace tactor::plot
