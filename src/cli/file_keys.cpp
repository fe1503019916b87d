// SPDX-License-Identifier: MIT
#include "cli/file_keys.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/say.hpp"
#include "core/split.hpp"

namespace tactor::cli {
namespace {

struct file_key {
    std::string_view table;
    std::string_view name; ///< "out.pulse_ms" for the key pulse_ms in the inner table out
    std::string_view page;
    std::string_view range;
    std::string_view usual;
    std::string_view text;
    std::string_view mentions; ///< keys that the text mentions, separated by blanks
};

constexpr file_key all_keys[] = {
#include "cli/file_keys.inc"
};

/// Table whose keys are options. The help for the options explains these keys.
constexpr std::string_view options_table = "[defaults]";

std::string replace_hyphens(std::string_view word)
{
    std::string name(word);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

std::string_view strip_brackets(std::string_view table)
{
    const std::size_t begin = std::min(table.find_first_not_of('['), table.size());
    return table.substr(begin, table.find(']') - begin);
}

std::string full_name(const file_key& k)
{
    return fmt::format("{}.{}", strip_brackets(k.table), replace_hyphens(k.name));
}

// Returns true if `name` is the key's name: "pulse_ms", "out.pulse_ms" or "sync.out.pulse_ms".
bool has_name(const file_key& k, std::string_view name)
{
    return ("." + full_name(k)).ends_with(fmt::format(".{}", name));
}

std::string describe_entry(const file_key& k)
{
    std::string text = fmt::format("{}\n{}", k.name, wrap_text("  ", k.text));
    for (const auto& [title, fact] : {std::pair("Range:", k.range), {"Default:", k.usual}})
        if (!fact.empty())
            text += fmt::format("  {:<18}{}\n", title, fact);
    return text + fmt::format("  {:<18}{}, see {}\n", "In files:", k.table, k.page);
}

// Returns one or two lines about a table, such as "sync" or "sync.out", or "" if there is no such table.
std::string describe_table(std::string_view name)
{
    std::vector<std::string_view> names;
    const file_key* first = nullptr;
    const std::string begin = fmt::format("{}.", name);
    for (const file_key& k : all_keys) {
        const std::string_view table = strip_brackets(k.table);
        if (table == name || k.name.starts_with(begin) ||
            (begin.starts_with(fmt::format("{}.", table)) && full_name(k).starts_with(begin))) {
            first = first == nullptr ? &k : first;
            names.push_back(k.name);
        }
    }
    return first == nullptr
               ? ""
               : fmt::format("{}: see {}; tactor help KEY explains a key\n{}", first->table, first->page,
                             wrap_text("  ", fmt::format("{}", fmt::join(names, ", "))));
}

void append_block(std::string& text, const std::string& more)
{
    text += (text.empty() || more.empty() ? "" : "\n") + more;
}

} // namespace

std::string describe_key(std::string_view word, std::span<const std::string_view> besides)
{
    std::string text;
    const std::string name = replace_hyphens(strip_brackets(word));
    for (const file_key& k : all_keys)
        if (has_name(k, name) && k.table != options_table &&
            std::find(besides.begin(), besides.end(), k.table) == besides.end())
            append_block(text, describe_entry(k));
    append_block(text, describe_table(name));
    return text;
}

std::string describe_related_keys(std::string_view word)
{
    std::string text;
    const std::string name = replace_hyphens(word);
    const std::size_t dot = name.rfind('.');
    for (const file_key& k : all_keys) {
        const auto words = detail::split(k.mentions, ' ');
        if (k.table != options_table && (dot == name.npos || has_name(k, name.substr(0, dot))) &&
            std::find(words.begin(), words.end(), name.substr(dot + 1)) != words.end())
            append_block(text, describe_entry(k));
    }
    return text;
}

std::vector<std::string> list_key_names()
{
    std::vector<std::string> names;
    for (const file_key& k : all_keys)
        if (k.table != options_table) {
            names.push_back(full_name(k));
            names.push_back(names.back().substr(names.back().rfind('.') + 1));
        }
    return names;
}

} // namespace tactor::cli
