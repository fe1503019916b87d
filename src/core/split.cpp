// SPDX-License-Identifier: MIT
#include "core/split.hpp"

#include <charconv>
#include <limits>
#include <system_error>

namespace tactor::detail {
namespace {

// Returns true if the number is too large for a double. std::from_chars reports numbers that are too large
// and too small as the same error.
bool too_large(std::string_view number) noexcept
{
    const std::size_t e = number.find_first_of("eE");
    if (e != std::string_view::npos)
        return number[e + 1] != '-';
    return number.substr(0, number.find('.')).find_first_of("123456789") != std::string_view::npos;
}

} // namespace

bool blank(char c) noexcept
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\f' || c == '\r';
}

std::string_view without_blanks(std::string_view text) noexcept
{
    while (!text.empty() && blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && blank(text.back()))
        text.remove_suffix(1);
    return text;
}

void skip_blanks(std::string_view text, std::size_t& at) noexcept
{
    while (at < text.size() && blank(text[at]))
        ++at;
}

std::optional<double> scan_number(std::string_view text, std::size_t& at) noexcept
{
    const bool has_sign = at < text.size() && (text[at] == '+' || text[at] == '-');
    const std::size_t from = has_sign ? at + 1 : at;
    // std::from_chars also accepts a minus sign, inf and nan.
    if (from >= text.size() || std::string_view(".0123456789").find(text[from]) == std::string_view::npos)
        return std::nullopt;
    double value = 0.0;
    const char* const begin = text.data() + from;
    const auto [end, fault] = std::from_chars(begin, text.data() + text.size(), value);
    if (fault == std::errc::invalid_argument)
        return std::nullopt;
    if (fault == std::errc::result_out_of_range)
        value = too_large({begin, end}) ? std::numeric_limits<double>::infinity() : 0.0;
    if (text[at] == '-')
        value = -value;
    at = static_cast<std::size_t>(end - text.data());
    return value;
}

} // namespace tactor::detail
