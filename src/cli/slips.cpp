// SPDX-License-Identifier: MIT
#include "cli/slips.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/path.hpp>

#include "core/suggest.hpp"

namespace tactor::cli {
namespace {

using words_type = std::vector<std::string>;

// Characters that word processors, PDFs and web pages put in place of those of a keyboard.
struct typeset {
    std::string_view written; // UTF-8
    std::string_view name;
    std::string_view meant; // where it is not part of a number
};
constexpr std::array typesets{typeset{"\u2010", "a hyphen", "-"},
                              typeset{"\u2011", "a non-breaking hyphen", "-"},
                              typeset{"\u2012", "a figure dash", "-"},
                              typeset{"\u2013", "an en dash", "--"},
                              typeset{"\u2014", "an em dash", "--"},
                              typeset{"\u2212", "a minus sign", "-"},
                              typeset{"\u201c", "an opening quotation mark", "\""},
                              typeset{"\u201d", "a closing quotation mark", "\""},
                              typeset{"\u2018", "an opening quotation mark", "'"},
                              typeset{"\u2019", "a closing quotation mark", "'"}};

bool is_number(std::string_view rest)
{
    return !rest.empty() && ((rest.front() >= '0' && rest.front() <= '9') || rest.front() == '.');
}

// Returns a word as a keyboard types it. Sets `found` to its first character that no keyboard has.
std::string retype(std::string_view word, const typeset*& found)
{
    std::string typed;
    while (!word.empty()) {
        const auto t = std::find_if(typesets.begin(), typesets.end(),
                                    [&](const typeset& x) { return word.starts_with(x.written); });
        if (t == typesets.end()) {
            typed += word.front();
            word.remove_prefix(1);
            continue;
        }
        found = found == nullptr ? &*t : found;
        word.remove_prefix(t->written.size());
        const bool dash = t->meant.front() == '-';
        if (dash && typed.ends_with("--"))
            continue; // it stands for both
        // "-D" has one dash, and so has a number; a dash beside another one completes "--".
        const bool one = is_number(word) || word.size() == 1 || typed.ends_with('-') || word.starts_with('-');
        typed += dash && one ? "-" : t->meant;
    }
    return typed;
}

// Names of files may have such characters inside, options and numbers begin with them.
bool may_be_typeset(std::string_view word)
{
    return std::any_of(typesets.begin(), typesets.end(), [&](const typeset& t) {
        const std::size_t at = word.find(t.written);
        return at == 0 || (at != std::string_view::npos &&
                           std::string_view("-= ,").find(word[at - 1]) != std::string_view::npos);
    });
}

std::string quote_blanks(const std::string& word)
{
    return word.find(' ') == std::string::npos ? word : fmt::format("\"{}\"", word);
}

std::string join(const words_type& words, std::size_t begin, std::size_t end)
{
    return fmt::format("{}", fmt::join(words.begin() + static_cast<std::ptrdiff_t>(begin),
                                       words.begin() + static_cast<std::ptrdiff_t>(end), " "));
}

std::optional<error> find_typeset(const words_type& words)
{
    const typeset* found = nullptr;
    for (const std::string& word : words) {
        if (!may_be_typeset(word))
            continue;
        const std::string typed = retype(word, found);
        const bool quote = found->meant.find('-') == std::string_view::npos;
        return error(error_kind::bad_input, word, fmt::format("it has {}, as in print", found->name),
                     quote ? fmt::format("type {} on the keyboard", found->meant) : "type " + typed);
    }
    return {};
}

// Returns the error for words before the command. A slip of a command's own name is another one.
std::optional<error> find_late_command(const words_type& words, const words_type& commands)
{
    const auto is_command = [&](const std::string& w) {
        return std::find(commands.begin(), commands.end(), w) != commands.end();
    };
    const std::vector<std::string_view> names(commands.begin(), commands.end());
    const auto at = std::find_if(words.begin(), words.end(), is_command);
    if (at == words.begin() || at == words.end() || !detail::nearest_name(words.front(), names).empty())
        return {};
    std::string line = "tactor " + *at;
    for (auto w = words.begin(); w != words.end(); ++w)
        if (w != at)
            line += " " + quote_blanks(*w);
    return error(error_kind::bad_input, words.front(), "it stands before the command",
                 "the command comes first: " + line);
}

bool is_path(const std::string& data)
{
    try {
        static_cast<void>(path::from_svg(data));
        return true;
    } catch (const error&) {
        return false;
    }
}

std::optional<error> find_open_path(const words_type& words)
{
    const auto option = std::find(words.begin(), words.end(), "--path");
    const std::size_t first = static_cast<std::size_t>(option - words.begin()) + 1;
    std::size_t end = first;
    const auto goes_on = [&](const std::string& w) {
        return !w.starts_with('-') || is_number(std::string_view(w).substr(1));
    };
    while (end < words.size() && goes_on(words[end]))
        ++end;
    const std::string data = end < first + 2 ? "" : join(words, first, end);
    if (!is_path(data))
        return {};
    return error(error_kind::bad_input, "--path", "its data are without quotes",
                 fmt::format("quote the path: --path \"{}\"", data));
}

std::optional<error> find_open_name(const words_type& words)
{
    constexpr std::size_t most_words = 8;
    for (std::size_t i = 0; i < words.size(); ++i)
        for (std::size_t end = i + 2; end <= std::min(words.size(), i + most_words); ++end) {
            const std::string name = join(words, i, end);
            std::error_code ignored;
            if (std::filesystem::exists(name, ignored))
                return error(error_kind::bad_input, name, "the name has blanks and no quotes",
                             fmt::format("quote it: \"{}\"", name));
        }
    return {};
}

} // namespace

std::optional<error> find_slip(const words_type& words, const words_type& commands)
{
    if (auto x = find_typeset(words))
        return x;
    if (auto x = find_late_command(words, commands))
        return x;
    if (auto x = find_open_path(words))
        return x;
    return find_open_name(words);
}

} // namespace tactor::cli
