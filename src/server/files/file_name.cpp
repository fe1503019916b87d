// SPDX-License-Identifier: MIT
#include "server/files/file_name.hpp"

#include <algorithm>
#include <cstddef>

namespace tactor::server {
namespace {

constexpr std::size_t longest = 100;

// Returns the bytes of the first character if it is a letter, digit, blank, - or _; else 0. Beyond ASCII all
// are letters but what is below U+00C0 (controls and signs) and from U+2000 to U+207F (controls of direction
// and width).
std::size_t allowed(std::string_view rest) noexcept
{
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 -_";
    const auto first = static_cast<unsigned char>(rest.front());
    if (first < 0x80)
        return plain.find(rest.front()) != plain.npos ? 1 : 0;
    const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC3 ? 2 : 0;
    if (bytes == 0 || bytes > rest.size() || rest.starts_with("\xE2\x80") || rest.starts_with("\xE2\x81"))
        return 0;
    const bool is_whole = std::all_of(rest.begin() + 1, rest.begin() + static_cast<std::ptrdiff_t>(bytes),
                                      [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; });
    return is_whole ? bytes : 0;
}

} // namespace

bool is_file_name(std::string_view name) noexcept
{
    if (name.empty() || name.size() > longest || name.front() == '-' || name.front() == ' ' ||
        name.back() == ' ')
        return false;
    while (!name.empty()) {
        const std::size_t bytes = allowed(name);
        if (bytes == 0)
            return false;
        name.remove_prefix(bytes);
    }
    return true;
}

std::string make_file_name(std::string_view name)
{
    std::string made;
    while (!name.empty()) {
        const std::size_t bytes = allowed(name);
        if (made.size() + std::max<std::size_t>(bytes, 1) > longest)
            break;
        made += bytes == 0 ? "_" : name.substr(0, bytes);
        name.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    if (!made.empty() && (made.front() == '-' || made.front() == ' '))
        made.front() = '_';
    while (made.ends_with(' '))
        made.pop_back();
    return made.empty() ? "stroke" : made;
}

} // namespace tactor::server
