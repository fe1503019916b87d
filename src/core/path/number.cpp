// SPDX-License-Identifier: MIT
#include "core/path/number.hpp"

#include <charconv>
#include <limits>
#include <system_error>

namespace tactor::detail {
namespace {

std::size_t digits_end(std::string_view text, std::size_t at) noexcept
{
    while (at < text.size() && text[at] >= '0' && text[at] <= '9')
        ++at;
    return at;
}

// Returns true if the number is too large. std::from_chars reports too large and too small as the same error.
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
    const auto is = [text](std::size_t i, char a, char b) {
        return i < text.size() && (text[i] == a || text[i] == b);
    };
    const std::size_t unsigned_from = is(at, '+', '-') ? at + 1 : at;
    std::size_t end = digits_end(text, unsigned_from);
    std::size_t digits = end - unsigned_from;
    if (is(end, '.', '.')) {
        const std::size_t fraction_end = digits_end(text, end + 1);
        digits += fraction_end - end - 1;
        end = fraction_end;
    }
    if (digits == 0)
        return std::nullopt;
    if (is(end, 'e', 'E')) {
        const std::size_t exponent = is(end + 1, '+', '-') ? end + 2 : end + 1;
        if (const std::size_t exponent_end = digits_end(text, exponent); exponent_end > exponent)
            end = exponent_end;
    }
    double value = 0.0;
    const auto result = std::from_chars(text.data() + unsigned_from, text.data() + end, value);
    if (result.ec == std::errc::result_out_of_range)
        value = too_large(text.substr(unsigned_from, end - unsigned_from))
                    ? std::numeric_limits<double>::infinity()
                    : 0.0;
    if (is(at, '-', '-'))
        value = -value;
    at = end;
    return value;
}

} // namespace tactor::detail
