// SPDX-License-Identifier: MIT
#include "sink/alsa/plain_name.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace tactor::alsa {
namespace {

constexpr std::size_t longest = 200; // bytes; a card's id has 15

// Returns true for a character of a name. Does not use std::isalnum(), which depends on the locale.
bool is_name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

bool is_value_character(char c)
{
    return is_name_character(c) || c == '.';
}

// Returns the fault of a text that is empty or has a character that `may` rejects. Empty if there is no
// fault.
std::string find_character_fault(std::string_view text, bool (*may)(char))
{
    if (text.empty())
        return "a part of it is empty";
    const auto bad = std::find_if_not(text.begin(), text.end(), may);
    if (bad == text.end())
        return {};
    const auto c = static_cast<unsigned char>(*bad);
    return c > 0x20 && c < 0x7f ? fmt::format("it must not contain {}", *bad)
                                : fmt::format("it must not contain the byte 0x{:02x}", c);
}

std::string find_argument_fault(std::string_view text)
{
    const auto equals = text.find('=');
    if (equals == text.npos)
        return find_character_fault(text, is_value_character);
    std::string why = find_character_fault(text.substr(0, equals), is_name_character);
    return why.empty() ? find_character_fault(text.substr(equals + 1), is_value_character) : why;
}

std::string find_simple_name_fault(std::string_view name)
{
    const auto colon = name.find(':');
    if (std::string why = find_character_fault(name.substr(0, colon), is_name_character);
        !why.empty() || colon == name.npos)
        return why;
    if (name.substr(0, colon) == "plug")
        return "plug over plug";
    for (std::string_view rest = name.substr(colon + 1);;) {
        const auto comma = rest.find(',');
        if (std::string why = find_argument_fault(rest.substr(0, comma)); !why.empty() || comma == rest.npos)
            return why;
        rest.remove_prefix(comma + 1);
    }
}

// Returns the fault of the value that ALSA reads as the argument SLAVE of plug. Empty if there is no fault.
std::string find_slave_name_fault(std::string_view text)
{
    constexpr std::string_view key = "SLAVE=";
    if (text.substr(0, key.size()) == key)
        text.remove_prefix(key.size());
    if (text.size() >= 2 && text.front() == '\'' && text.back() == '\'')
        return find_simple_name_fault(text.substr(1, text.size() - 2));
    if (text.find(',') != text.npos)
        return "a name with a comma within plug: needs single quotes";
    return find_simple_name_fault(text);
}

} // namespace

std::string find_plain_name_fault(std::string_view name)
{
    constexpr std::string_view plug = "plug:";
    if (name.size() > longest)
        return fmt::format("it is longer than {} bytes", longest);
    return name.substr(0, plug.size()) == plug ? find_slave_name_fault(name.substr(plug.size()))
                                               : find_simple_name_fault(name);
}

} // namespace tactor::alsa
