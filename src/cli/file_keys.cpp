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

bool has_name(const file_key& k, std::string_view name)
{
    const std::string own = replace_hyphens(k.name);
    return own == name || own.substr(own.rfind('.') + 1) == name;
}

std::string_view strip_brackets(std::string_view table)
{
    const std::size_t begin = std::min(table.find_first_not_of('['), table.size());
    return table.substr(begin, table.find(']') - begin);
}

std::string describe_entry(const file_key& k)
{
    std::string text = fmt::format("{}\n{}", k.name, wrap_text("  ", k.text));
    for (const auto& [title, said] : {std::pair("Range:", k.range), {"Default:", k.usual}})
        if (!said.empty())
            text += fmt::format("  {:<18}{}\n", title, said);
    return text + fmt::format("  {:<18}{}, see {}\n", "In files:", k.table, k.page);
}

// Returns one or two lines about a table, or "" if there is no such table.
std::string describe_table(std::string_view name)
{
    std::vector<std::string_view> names;
    const file_key* first = nullptr;
    for (const file_key& k : all_keys)
        if (strip_brackets(k.table) == name || k.name.starts_with(fmt::format("{}.", name))) {
            first = first == nullptr ? &k : first;
            names.push_back(k.name);
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
    const std::string name = replace_hyphens(word);
    for (const file_key& k : all_keys)
        if (has_name(k, name) && k.table != options_table &&
            std::find(besides.begin(), besides.end(), k.table) == besides.end())
            append_block(text, describe_entry(k));
    append_block(text, describe_table(strip_brackets(word)));
    return text;
}

std::string describe_related_keys(std::string_view word)
{
    std::string text;
    const std::string name = replace_hyphens(word);
    for (const file_key& k : all_keys) {
        const auto words = detail::split(k.mentions, ' ');
        if (k.table != options_table && std::find(words.begin(), words.end(), name) != words.end())
            append_block(text, describe_entry(k));
    }
    return text;
}

} // namespace tactor::cli
