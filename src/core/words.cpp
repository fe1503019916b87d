// SPDX-License-Identifier: MIT
#include "core/words.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace tactor {
namespace {

constexpr double no_time_s = 0.5e-9;  // rounding errors of sums are smaller
constexpr double small_time_s = 1e-4; // smaller times in seconds have too many zeros to read
constexpr int most_decimals = 12;
constexpr std::size_t longest_label = 40; // the number in label_hint

struct range {
    char32_t first;
    char32_t last;
};

// C0; DEL and C1; line and paragraph separators and the bidirectional marks after them; bidirectional
// isolates.
constexpr range controls[] = {{0x00, 0x1f}, {0x7f, 0x9f}, {0x2028, 0x202e}, {0x2066, 0x2069}};

// Controls, spaces, the characters that Unicode calls Default_Ignorable_Code_Point, and blank letters of
// Hangul and Braille.
constexpr range invisible[] = {{0x00, 0x20},       {0x7f, 0xa0},      {0xad, 0xad},     {0x34f, 0x34f},
                               {0x61c, 0x61c},     {0x115f, 0x1160},  {0x1680, 0x1680}, {0x17b4, 0x17b5},
                               {0x180b, 0x180f},   {0x2000, 0x200f},  {0x2028, 0x202f}, {0x205f, 0x206f},
                               {0x2800, 0x2800},   {0x3000, 0x3000},  {0x3164, 0x3164}, {0xfe00, 0xfe0f},
                               {0xfeff, 0xfeff},   {0xffa0, 0xffa0},  {0xfff0, 0xfff8}, {0x1bca0, 0x1bca3},
                               {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff}};

bool is_in(std::span<const range> ranges, char32_t c)
{
    return std::ranges::any_of(ranges, [c](const range& r) { return c >= r.first && c <= r.last; });
}

// Returns the character at offset i, and moves i behind it.
char32_t next_character(std::string_view utf8, std::size_t& i)
{
    const auto lead = static_cast<unsigned char>(utf8[i++]);
    char32_t c = lead < 0x80 ? lead : lead < 0xe0 ? lead & 0x1fU : lead < 0xf0 ? lead & 0x0fU : lead & 7U;
    for (; i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0U) == 0x80U; ++i)
        c = c << 6U | (static_cast<unsigned char>(utf8[i]) & 0x3fU);
    return c;
}

} // namespace

std::string counted(std::uint64_t n, std::string_view noun, std::string_view plural)
{
    if (n == 1)
        return fmt::format("1 {}", noun);
    return plural.empty() ? fmt::format("{} {}s", n, noun) : fmt::format("{} {}", n, plural);
}

std::string plain_number(double v, int digits)
{
    if (!std::isfinite(v) || v == 0.0)
        return fmt::format("{}", v == 0.0 ? 0.0 : v);
    // Number of digits before the point, minus one. If rounding adds a digit, the last digit is a surplus
    // zero.
    const auto magnitude = static_cast<int>(std::floor(std::log10(std::abs(v))));
    std::string s = fmt::format("{:.{}f}", v, std::clamp(digits - 1 - magnitude, 0, most_decimals));
    if (s.find('.') != std::string::npos) {
        s.erase(s.find_last_not_of('0') + 1);
        if (s.back() == '.')
            s.pop_back();
    }
    return s == "-0" ? "0" : s;
}

std::string seconds_text(double s, int digits)
{
    const double size = std::abs(s);
    if (size < no_time_s)
        return "0 s";
    if (size < 1e-6)
        return plain_number(s * 1e9, std::min(digits, 3)) + " ns";
    if (size < small_time_s)
        return plain_number(s * 1e6, std::min(digits, 3)) + " us";
    return plain_number(s, digits) + " s";
}

std::string to_lower_case(std::string text)
{
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

std::string too_large_text(std::uint64_t bytes)
{
    return fmt::format("it has {} MB of samples, but tactor loads at most {} MB", bytes >> 20,
                       most_own_bytes >> 20);
}

std::string recording_name(const recording& r)
{
    return r.file.empty() ? "recording" : r.file;
}

std::string_view first_characters(std::string_view utf8, std::size_t most_bytes)
{
    std::size_t end = std::min(utf8.size(), most_bytes);
    while (end > 0 && end < utf8.size() && (static_cast<unsigned char>(utf8[end]) & 0xc0U) == 0x80U)
        --end; // the byte at `end` continues a character
    return utf8.substr(0, end);
}

bool has_controls(std::string_view utf8)
{
    for (std::size_t i = 0; i < utf8.size();)
        if (is_in(controls, next_character(utf8, i)))
            return true;
    return false;
}

std::string remove_invisible(std::string_view utf8)
{
    std::string out;
    for (std::size_t i = 0; i < utf8.size();) {
        const std::size_t from = i;
        if (!is_in(invisible, next_character(utf8, i)))
            out += utf8.substr(from, i - from);
    }
    return out;
}

std::string label_fault(std::string_view utf8)
{
    if (has_controls(utf8))
        return "has control characters";
    std::size_t count = 0;
    for (std::size_t i = 0; i < utf8.size(); ++count)
        next_character(utf8, i);
    if (count == 0)
        return "is empty";
    return count > longest_label ? "has " + counted(count, "character") : "";
}

} // namespace tactor
