// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/path.hpp>

#include "cli/option_words.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"

namespace tactor::cli {
namespace {

std::string nearest(const std::string& given, const std::vector<std::string>& names)
{
    const std::vector<std::string_view> views(names.begin(), names.end());
    return std::string(detail::nearest_name(given, views));
}

const CLI::App& used_command(const CLI::App& app)
{
    const auto used = app.get_subcommands();
    return used.empty() ? app : *used.front();
}

// Without the dashes, which would make any two names more alike than they are.
std::vector<std::string> option_names(const CLI::App& command)
{
    std::vector<std::string> names;
    for (const CLI::Option* o : command.get_options())
        for (const std::string& l : o->get_lnames())
            names.push_back(l);
    return names;
}

// Names that other programs have for such options.
struct foreign_name {
    std::string_view name;
    std::string_view here;
};
constexpr std::array foreign_names{
    foreign_name{"volume", "level-dbfs"}, foreign_name{"gain", "level-dbfs"}, foreign_name{"port", "http"},
    foreign_name{"frequency", "carrier"}, foreign_name{"card", "device"},     foreign_name{"pcm", "device"},
};

// The option that a name is a slip of, or nothing. Of a short name one letter makes another word: then its
// beginning must agree ("seed" is not "speed", "sped" may be).
std::string nearest_option(const std::string& given, const std::vector<std::string>& names)
{
    constexpr std::size_t short_name = 4;
    const std::string bare(bare_name(given));
    for (const foreign_name& f : foreign_names)
        if (f.name == bare && std::find(names.begin(), names.end(), f.here) != names.end())
            return fmt::format("--{}", f.here);
    const std::string like = nearest(bare, names);
    if (like.empty() || (bare.size() <= short_name && bare.substr(0, 2) != like.substr(0, 2)))
        return {};
    return "--" + like;
}

// Returns the options that a letter may stand for: the one that has it in the other case, else those that
// begin with it, unless there are many.
std::string options_by_letter(char letter, const CLI::App& command)
{
    constexpr std::size_t many = 3;
    const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
    std::vector<std::string> like;
    for (const CLI::Option* o : command.get_options()) {
        for (const std::string& s : o->get_snames())
            if (lower(s.front()) == lower(letter))
                return "-" + s;
        for (const std::string& l : o->get_lnames())
            if (l.front() == lower(letter))
                like.push_back("--" + l);
    }
    return like.size() < many ? fmt::format("{}", fmt::join(like, " or ")) : "";
}

std::string help_command(const CLI::App& app, const CLI::App& command)
{
    return "tactor " + (&command == &app ? "" : command.get_name() + " ") + "--help";
}

// Returns the error for a missing command, argument or option.
error missing(const CLI::App& app, const CLI::App& command)
{
    if (&command == &app)
        return no_command();
    const std::string help = help_command(app, command);
    const auto options = command.get_options();
    const auto o = std::find_if(options.begin(), options.end(),
                                [](const CLI::Option* x) { return x->get_required() && x->count() == 0; });
    if (o == options.end())
        return {error_kind::bad_input, "command line", "something is missing", help};
    const std::string name = (*o)->get_name();
    if (name.starts_with('-'))
        return {error_kind::bad_input, name, "this option is missing",
                fmt::format("say {} {}; {}", name, (*o)->get_type_name(), help)};
    return {error_kind::bad_input, "command line", "no " + name,
            fmt::format("tactor {} {}; {}", command.get_name(), name, help)};
}

// An option with too few values or too many: its name comes first in what the parser says.
error miscounted(const CLI::App& app, const CLI::App& command, const std::string& said)
{
    const std::string name = said.substr(0, said.find_first_of(": "));
    const CLI::Option* o = command.get_option_no_throw(name);
    if (o == nullptr)
        return {error_kind::bad_input, "command line", said, help_command(app, command)};
    if (o->count() > 1)
        return {error_kind::bad_input, name, "it is given more than once", "give it once"};
    return {error_kind::bad_input, name, "its value is missing",
            fmt::format("say {} {}; {}", name, o->get_type_name(), help_command(app, command))};
}

// An option without another one that it needs, or beside one that it excludes: both are in what the parser
// says.
error unpaired(const CLI::App& app, const CLI::App& command, const std::string& said)
{
    const std::size_t blank = said.find(' ');
    return {error_kind::bad_input, said.substr(0, blank), "it" + said.substr(blank),
            help_command(app, command)};
}

error unknown(const CLI::App& app, const CLI::App& command)
{
    const auto left = app.remaining(true);
    const std::string given = left.empty() ? "" : left.front();
    const std::string help = help_command(app, command) + " lists them";
    if (given.starts_with('-')) {
        const std::string name = given.substr(0, given.find('='));
        const std::string like = name.size() == 2 ? options_by_letter(name[1], command)
                                                  : nearest_option(name, option_names(command));
        return {error_kind::bad_input, name, "no such option",
                like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
    }
    if (&command == &app)
        return no_such_command(app, given);
    const auto takes = command.get_options([](const CLI::Option* o) { return o->get_positional(); });
    return {error_kind::bad_input, given, "one argument too many",
            takes.empty() ? help
                          : fmt::format("{} takes one {}; quote a name that has blanks", command.get_name(),
                                        takes.front()->get_name(true))};
}

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

error no_command()
{
    return {error_kind::bad_input, "command line", "no command", "tactor --help lists them"};
}

error no_such_command(const CLI::App& app, const std::string& given)
{
    std::vector<std::string> names;
    for (const CLI::App* c : app.get_subcommands({}))
        names.push_back(c->get_name());
    const std::string like = nearest(given, names);
    const std::string help = help_command(app, app) + " lists them";
    return {error_kind::bad_input, given, "no such command",
            like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
}

error usage_error(const CLI::App& app, const CLI::ParseError& e)
{
    const CLI::App& command = used_command(app);
    if (!app.remaining().empty()) // words before the command
        return unknown(app, app);
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
        return unknown(app, command);
    if (dynamic_cast<const CLI::RequiredError*>(&e) != nullptr)
        return missing(app, command);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&e) != nullptr)
        return miscounted(app, command, e.what());
    if (dynamic_cast<const CLI::RequiresError*>(&e) != nullptr ||
        dynamic_cast<const CLI::ExcludesError*>(&e) != nullptr)
        return unpaired(app, command, e.what());
    return {error_kind::bad_input, "command line", e.what(), help_command(app, command)};
}

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
