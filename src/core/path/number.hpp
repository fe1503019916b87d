// SPDX-License-Identifier: MIT
// Numbers as SVG and CSV write them, in every locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::detail {

/// A fault in a value, and its place in the text.
struct value_fault {
    std::size_t offset = 0;
    std::string why;
    std::string hint;
};

/// Returns true for blank, tab, line feed, form feed and carriage return.
bool blank(char c) noexcept;

/// Returns the text without blanks at both ends.
std::string_view without_blanks(std::string_view text) noexcept;

/// Moves `at` behind blanks.
void skip_blanks(std::string_view text, std::size_t& at) noexcept;

/// Reads the number that begins at `at` and moves `at` behind it. Without a number returns nothing and leaves
/// `at`. Returns infinity if it is too large for a double. An 'e' without digits is not part of it.
std::optional<double> scan_number(std::string_view text, std::size_t& at) noexcept;

} // namespace tactor::detail
