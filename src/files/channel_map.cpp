// SPDX-License-Identifier: MIT
#include "files/setup_text.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/setup_parts.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

// Bytes from `from` to `to` become `text`.
struct edit {
    std::size_t from = 0;
    std::size_t to = 0;
    std::string text = {};
};

// toml++ counts lines and characters from 1.
std::size_t find_offset(std::string_view text, const toml::source_position& at)
{
    std::size_t i = 0;
    for (unsigned line = 1; line < at.line && i < text.size(); ++i)
        line += text[i] == '\n';
    for (unsigned column = 1; column < at.column && i < text.size(); ++column) {
        ++i;
        while (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U)
            ++i;
    }
    return i;
}

std::size_t next_line(std::string_view text, std::size_t i)
{
    const std::size_t end = text.find('\n', i);
    return end == text.npos ? text.size() : end + 1;
}

// Returns the entry that speaks of a tactor: by its number, or by its place in the file where there is no
// grid.
const toml::table* find_entry(const toml::table& document, std::size_t tactor, bool numbered)
{
    const toml::array* entries = document["tactor"].as_array();
    if (entries == nullptr)
        return nullptr;
    if (!numbered)
        return tactor < entries->size() ? entries->get(tactor)->as_table() : nullptr;
    for (const toml::node& e : *entries) {
        const toml::table* t = e.as_table();
        if (t != nullptr && (*t)["tactor"].value<std::int64_t>() == static_cast<std::int64_t>(tactor))
            return t;
    }
    return nullptr;
}

edit change(std::string_view text, const toml::table& entry, unsigned channel)
{
    if (const toml::node* said = entry.get("channel"))
        return {find_offset(text, said->source().begin), find_offset(text, said->source().end),
                fmt::format("{}", channel)};
    const std::size_t begin = find_offset(text, entry.source().begin);
    if (entry.is_inline())
        return {begin + 1, begin + 1, fmt::format(" channel = {},", channel)};
    const std::size_t line = next_line(text, begin);
    const bool cut = line == text.size() && !text.ends_with('\n');
    return {line, line, fmt::format("{}channel = {}\n", cut ? "\n" : "", channel)};
}

std::string apply(std::string text, std::vector<edit> edits)
{
    std::sort(edits.begin(), edits.end(), [](const edit& a, const edit& b) { return a.from > b.from; });
    for (const edit& e : edits)
        text.replace(e.from, e.to - e.from, e.text);
    return text;
}

std::string edited(const std::string& text, const std::string& name, const array& now,
                   std::span<const unsigned> channels)
{
    const toml::table document = parse_toml(text, name);
    const auto base = document["array"];
    const bool numbered = base["grid"] || base["preset"] || base["file"];
    std::vector<edit> edits;
    std::string added;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (now.tactors[i].channel == channels[i])
            continue;
        if (const toml::table* entry = find_entry(document, i, numbered))
            edits.push_back(change(text, *entry, channels[i]));
        else
            added += fmt::format("\n[[tactor]]\ntactor = {}\nchannel = {}\n", i, channels[i]);
    }
    std::string out = apply(text, std::move(edits));
    if (!added.empty() && !out.ends_with('\n'))
        out += '\n';
    return out + added;
}

} // namespace

std::string with_channels(const std::filesystem::path& file, std::span<const unsigned> channels)
{
    const std::string text{std::string_view(read_text_file(file, max_setup_bytes))};
    std::error_code ignored;
    const setup_source source{
        file.string(), file.parent_path(), {std::filesystem::weakly_canonical(file, ignored)}};
    const setup before = read_setup(text, source).said;
    if (!before.array)
        throw error(error_kind::bad_input, source_place{file.string()}, "says no [array]",
                    "see tactor.toml(5)");
    if (before.array->tactors.size() != channels.size())
        throw error(error_kind::bad_input, source_place{file.string()},
                    fmt::format("{} for {}", counted(channels.size(), "channel"),
                                counted(before.array->tactors.size(), "tactor")),
                    "give one for each");
    std::string out = edited(text, source.name, *before.array, channels);
    const setup after = read_setup(out, source).said;
    for (std::size_t i = 0; i < channels.size(); ++i)
        if (!after.array || after.array->tactors.size() != channels.size() ||
            after.array->tactors[i].channel != channels[i])
            throw error(error_kind::bad_input, source_place{file.string()},
                        fmt::format("the channel of tactor {} cannot be changed in its text", i),
                        "write it as channel = N in a [[tactor]] entry of its own");
    return out;
}

} // namespace tactor::detail
