// SPDX-License-Identifier: MIT
// Numbers as SVG and CSV write them, in every locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::detail {

/// What is wrong with a value, and where in its text.
struct value_fault {
    std::size_t offset = 0;
    std::string why;
    std::string hint;
};

/// Blank, tab, line feed, form feed, carriage return.
bool blank(char c) noexcept;

/// Returns the text without blanks at both ends.
std::string_view without_blanks(std::string_view text) noexcept;

/// Goes on behind blanks.
void skip_blanks(std::string_view text, std::size_t& at) noexcept;

/// The number that begins at `at`, which then is behind it; nothing, and `at` unmoved, if none does. Infinite
/// where it is too large for a double. An 'e' without digits does not belong to it.
std::optional<double> scan_number(std::string_view text, std::size_t& at) noexcept;

} // namespace tactor::detail
