// SPDX-License-Identifier: MIT
#include "core/marks.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace tactor::detail {
namespace {

constexpr std::string_view command = "command:";
constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz_";

// Parses a text with the braces around it. Returns nothing if it is not a mark.
std::optional<mark> read(std::string_view text) noexcept
{
    const std::string_view inside = text.substr(1, text.size() - 2);
    const std::string_view setting = inside.substr(0, inside.find('|'));
    const std::string_view name = setting.substr(0, setting.find('='));
    const std::string_view word = name.substr(name.starts_with(command) ? command.size() : 0);
    if (word.empty() || word.find_first_not_of(letters) != word.npos)
        return std::nullopt;
    return mark{.text = text,
                .setting = setting,
                .name = name,
                .value = setting.substr(std::min(name.size() + 1, setting.size())),
                .clause = inside.substr(std::min(setting.size() + 1, inside.size()))};
}

} // namespace

std::optional<mark> find_mark(std::string_view text) noexcept
{
    for (std::size_t begin = text.find('{'); begin != text.npos; begin = text.find('{', begin + 1)) {
        const std::size_t end = text.find('}', begin);
        if (end == text.npos)
            break;
        if (const auto m = read(text.substr(begin, end + 1 - begin)))
            return m;
    }
    return std::nullopt;
}

std::string_view command_name(const mark& m) noexcept
{
    return m.name.substr(m.name.starts_with(command) ? command.size() : m.name.size());
}

std::string plain(const mark& m)
{
    if (m.setting == "fit=true") // fit is a function in the library, not an option of a plan
        return "fit_strokes()";
    if (!command_name(m).empty())
        return fmt::format("tactor {}", command_name(m));
    return m.value.empty() ? std::string(m.name) : fmt::format("{} = {}", m.name, m.value);
}

std::string plain(std::string_view marked)
{
    return replace_marks(marked, [](const mark& m) { return plain(m).append(m.clause); });
}

} // namespace tactor::detail
