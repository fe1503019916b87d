// SPDX-License-Identifier: MIT
/// \file
/// Parsers for lists and numbers in text.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace tactor::detail {

/// Returns the parts between separators as views of `text`. n separators give n + 1 parts. Parts may be
/// empty.
inline std::vector<std::string_view> split(std::string_view text, char separator)
{
    std::vector<std::string_view> parts;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(separator, at), text.size());
        parts.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

/// Parses a text that contains only a number. Returns nothing for any other text and for a number that T
/// cannot hold. `base` applies to whole numbers and is ten by default.
template <typename T, typename... Base>
std::optional<T> parse_number_text(std::string_view text, Base... base)
{
    T v{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), v, base...);
    return failed == std::errc() && end == text.data() + text.size() ? std::optional(v) : std::nullopt;
}

/// A fault in a value, with its offset in the text.
struct value_fault {
    std::size_t offset = 0;
    std::string why;
    std::string hint;
};

/// Returns true for space, tab, line feed, form feed and carriage return.
bool blank(char c) noexcept;

/// Returns the text without blanks at both ends.
std::string_view without_blanks(std::string_view text) noexcept;

/// Moves `at` past blanks.
void skip_blanks(std::string_view text, std::size_t& at) noexcept;

/// Reads a number in the syntax of SVG and CSV at `at`, and moves `at` behind the number. If there is no
/// number, returns nothing and does not change `at`. If the number is too large for a double, returns
/// infinity. An 'e' without digits after it is not read.
std::optional<double> scan_number(std::string_view text, std::size_t& at) noexcept;

} // namespace tactor::detail
