// SPDX-License-Identifier: MIT
#include "cli/wrapped.hpp"

#include <algorithm>
#include <string_view>

namespace tactor::cli {
namespace {

constexpr std::size_t width = 79;

// Characters, not bytes: labels and names may be UTF-8.
std::size_t columns(std::string_view s)
{
    std::size_t n = 0;
    for (const char c : s)
        n += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
    return n;
}

} // namespace

std::string wrapped(const std::string& first, const std::string& text)
{
    const std::string indent(columns(first), ' ');
    std::string all = first;
    std::size_t at = indent.size();
    bool begins = true;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t end = std::min(text.find(' ', i), text.size());
        const std::string word = text.substr(i, end - i);
        if (!begins && at + 1 + columns(word) > width) {
            all += '\n' + indent;
            at = indent.size();
            begins = true;
        }
        all += (begins ? "" : " ") + word;
        at += columns(word) + (begins ? 0 : 1);
        begins = false;
        i = end + 1;
    }
    return all + '\n';
}

} // namespace tactor::cli
