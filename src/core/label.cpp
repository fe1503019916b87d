// SPDX-License-Identifier: MIT
#include "core/label.hpp"

#include <algorithm>

#include "core/words.hpp"

namespace tactor {
namespace {

constexpr std::size_t longest = 40; // as in label_hint

struct range {
    char32_t first;
    char32_t last;
};

// C0, DEL and C1; ends of lines and paragraphs with the marks of direction behind them; its isolates.
constexpr range controls[] = {{0x00, 0x1f}, {0x7f, 0x9f}, {0x2028, 0x202e}, {0x2066, 0x2069}};

bool is_control(char32_t c)
{
    for (const range& r : controls)
        if (c >= r.first && c <= r.last)
            return true;
    return false;
}

// Returns the character at i, and sets i behind it.
char32_t next_character(std::string_view utf8, std::size_t& i)
{
    const auto lead = static_cast<unsigned char>(utf8[i++]);
    char32_t c = lead < 0x80 ? lead : lead < 0xe0 ? lead & 0x1fU : lead < 0xf0 ? lead & 0x0fU : lead & 7U;
    for (; i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0U) == 0x80U; ++i)
        c = c << 6U | (static_cast<unsigned char>(utf8[i]) & 0x3fU);
    return c;
}

} // namespace

std::string_view first_characters(std::string_view utf8, std::size_t most_bytes)
{
    std::size_t end = std::min(utf8.size(), most_bytes);
    while (end > 0 && end < utf8.size() && (static_cast<unsigned char>(utf8[end]) & 0xc0U) == 0x80U)
        --end; // within a character
    return utf8.substr(0, end);
}

bool has_controls(std::string_view utf8)
{
    for (std::size_t i = 0; i < utf8.size();)
        if (is_control(next_character(utf8, i)))
            return true;
    return false;
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
    return count > longest ? "has " + counted(count, "character") : "";
}

} // namespace tactor
