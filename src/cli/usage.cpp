// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/path.hpp>

#include "cli/file_keys.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor::cli {
namespace {

constexpr int name_columns = 26;
constexpr std::string_view options_prefix = "defaults."; // before a key that is an option
constexpr const char* own_group = "Options";             // CLI11's group for options without a group

std::string_view strip_dashes(std::string_view name) noexcept
{
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

const options::option* find_row(const CLI::Option& o)
{
    return o.get_lnames().empty() ? nullptr : options::find(o.get_lnames().front());
}

bool is_first(const CLI::Option& o)
{
    const options::option* row = find_row(o);
    return row != nullptr && (row->where & options::shown_first) != 0;
}

std::string append_type(const std::string& name, const std::string& type)
{
    return type.empty() ? name : fmt::format("{} {}", name, type);
}

std::string describe_line(const CLI::Option& o)
{
    const std::string name = append_type(o.get_name(false, true), o.get_type_name());
    return fmt::format("  {:<{}}{}{}\n", name, name_columns,
                       name.size() < name_columns ? "" : fmt::format("\n{:{}}", "", name_columns + 2),
                       spell_marks(o.get_description()));
}

constexpr std::array python_names{
    options::place_name{options::in_plan, "plan"}, options::place_name{options::in_score, "Score"},
    options::place_name{options::in_compare, "compare"}, options::place_name{options::in_player, "Player"}};

std::string places_text(std::span<const options::place_name> names, std::uint64_t where)
{
    std::string all;
    for (const options::place_name& p : names)
        if ((where & p.bit) != 0)
            all.append(all.empty() ? "" : ", ").append(p.name);
    return all;
}

std::string describe_row(const options::option& o)
{
    const bool is_key = (o.where & options::file_only) != 0;
    std::string text = fmt::format("{}\n  {}\n",
                                   append_type(is_key ? options::dashed(o) : option_name(o),
                                               o.what == options::kind::flag ? "" : options::type_text(o)),
                                   spell_marks(o.help));
    const auto line = [&text](const char* title, const std::string& fact) {
        if (!fact.empty())
            text += fmt::format("  {:<18}{}\n", title, fact);
    };
    const auto row = [](std::string_view name) { return option_name(*options::find(name)); };
    if (o.what == options::kind::number || o.what == options::kind::whole)
        line("Range:", spell_marks(options::range_text(o)));
    line("Not with:", o.rival.empty() ? "" : row(o.rival));
    line("Needs:", spell_marks(fmt::format("{}", fmt::join(detail::split(o.needs, '|'), " or "))));
    line(is_key ? "Used by:" : "Commands:", places_text(options::command_names(), o.where));
    const bool is_default = (o.where & options::in_defaults) != 0;
    line("[defaults]:", is_default ? options::dashed(o) : "");
    line("Stroke files:", (o.where & options::in_stroke) != 0 ? std::string(o.field_name()) : "");
    line("[[method]]:", (o.where & options::in_method) != 0 ? std::string(o.name) : "");
    line("JSON-RPC:", (o.where & options::by_client) != 0 ? fmt::format("options.{}", o.name) : "");
    line("OSC:", (o.where & options::by_client) != 0 ? fmt::format("{}=", o.name) : "");
    const bool is_limit = o.name == "power_dbfs" || o.name == "max_drive_s" || o.name == "drive_window_s";
    line("[limits]:", is_limit ? std::string(o.field_name()) : "");
    const std::string python = places_text(python_names, o.where);
    line("Python:", python.empty() ? "" : fmt::format("{} of {}", o.name, python));
    return text;
}

// Returns a command's usage, arguments and examples.
std::string describe_command(const CLI::App& app)
{
    std::string usage = fmt::format("Usage: tactor {} [OPTIONS]", app.get_name());
    std::string arguments;
    for (const CLI::Option* o : app.get_options([](const CLI::Option* x) { return x->get_positional(); })) {
        const std::string name = o->get_name(true) + (o->get_expected_max() > 1 ? "..." : "");
        usage += o->get_required() ? " " + name : fmt::format(" [{}]", name);
        arguments += fmt::format("\n  {:<12}{}\n", o->get_name(true), o->get_description());
    }
    if (app.get_parent() == nullptr)
        usage = "Usage: tactor COMMAND [OPTIONS]";
    return fmt::format("{}\n\n{}\n{}\nExamples:\n  {}\n\n", app.get_description(), usage, arguments,
                       fmt::join(detail::split(app.get_footer(), '\n'), "\n  "));
}

template <class F>
std::string list_options(const CLI::App& app, const std::string& title, F shows)
{
    std::string lines;
    for (const CLI::Option* o : app.get_options())
        if (o->nonpositional() && shows(*o))
            lines += describe_line(*o);
    return lines.empty() ? "" : fmt::format("{}:\n{}\n", title, lines);
}

// Returns the line with the number of options that --help leaves out.
std::string omitted_options_text(const CLI::App& app)
{
    const auto others = app.get_options([](const CLI::Option* o) {
        return o->nonpositional() && o->get_group() != own_group && !o->get_group().empty() && !is_first(*o);
    });
    if (others.empty())
        return {};
    return fmt::format("{}: tactor {} --help-all lists them, tactor help OPTION explains one.\n",
                       counted(others.size(), "more option"), app.get_name());
}

std::string nearest(const std::string& name, const std::vector<std::string>& names)
{
    const std::vector<std::string_view> views(names.begin(), names.end());
    return std::string(detail::nearest_name(name, views));
}

// Returns the names of options without dashes, because dashes make all names more similar.
std::vector<std::string> option_names(const CLI::App& command)
{
    std::vector<std::string> names;
    for (const CLI::Option* o : command.get_options())
        for (const std::string& l : o->get_lnames())
            names.push_back(l);
    return names;
}

// An option's name in other programs, and the name in tactor.
struct foreign_name {
    std::string_view name;
    std::string_view here;
};
// An option that a command does not have, and what to do instead.
struct other_way {
    std::string_view command;
    std::string_view name;
    std::string_view hint;
};
constexpr std::array other_ways{
    other_way{"serve", "level-dbfs", "use --max-level-dbfs to limit the levels that clients set"},
    other_way{"serve", "sl", "use --max-level-dbfs to limit the levels that clients set"},
    other_way{"experiment", "level-dbfs", "set level = { dbfs = -18 } in the definition"},
    other_way{"experiment", "sl", "set level = { sl_db = 7 } in the definition"},
    other_way{"calibrate", "level-dbfs", "set the level of the first trial with --start-dbfs"},
};

// Returns the hint for an option that a command uses but that can be set only in a file. Returns "" for other
// options.
std::string file_hint(const CLI::App& command, std::string_view name)
{
    const options::option* o = options::find(name);
    if (o == nullptr || (o->where & options::file_only) == 0)
        return {};
    for (const options::place_name& p : options::command_names())
        if (p.name == command.get_name() && (o->where & p.bit) != 0)
            return fmt::format("put {} into [defaults] of a file for --array", options::dashed(*o));
    return {};
}

constexpr std::array foreign_names{
    foreign_name{"volume", "level-dbfs"}, foreign_name{"gain", "level-dbfs"}, foreign_name{"port", "http"},
    foreign_name{"frequency", "carrier"}, foreign_name{"card", "device"},     foreign_name{"pcm", "device"},
};

// Returns the option that a misspelt name probably means, or nothing. In a short name a single letter makes
// another word, so the first letters of short names must be equal: "sped" may mean "speed", "seed" does not.
std::string nearest_option(const std::string& word, const std::vector<std::string>& names)
{
    constexpr std::size_t short_name = 4;
    const std::string bare(strip_dashes(word));
    for (const foreign_name& f : foreign_names)
        if (f.name == bare && std::find(names.begin(), names.end(), f.here) != names.end())
            return fmt::format("--{}", f.here);
    const std::string like = nearest(bare, names);
    if (like.empty() || (bare.size() <= short_name && bare.substr(0, 2) != like.substr(0, 2)))
        return {};
    return "--" + like;
}

// Returns the options that a letter may mean. If there is an option with this letter in the other case,
// returns this option. Otherwise returns the options that begin with the letter, unless there are many.
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

// Returns the error for a word that is not a command, nor one of `others`.
error unknown_word_error(const CLI::App& app, const std::string& word, const char* why,
                         const std::vector<std::string>& others = {})
{
    std::vector<std::string> names;
    for (const CLI::App* c : app.get_subcommands({}))
        names.push_back(c->get_name());
    names.insert(names.end(), others.begin(), others.end());
    const std::string like = nearest(std::string(strip_dashes(word)), names);
    const std::string help = help_command(app, app);
    return {error_kind::bad_input, word, why,
            like.empty() ? "see " + help : fmt::format("did you mean {}? See {}", like, help)};
}

// Returns the keys, without their tables, whose names contain `part` and more.
std::set<std::string> find_similar_keys(const std::vector<std::string>& names, std::string part)
{
    std::replace(part.begin(), part.end(), '-', '_');
    std::set<std::string> similar;
    for (const std::string& name : names)
        if (name != part && name.find('.') == name.npos && name.find(part) != name.npos)
            similar.insert(name);
    return similar;
}

// Returns the names of a command's arguments.
std::vector<std::string> list_arguments(const CLI::App& command)
{
    std::vector<std::string> names;
    for (const CLI::Option* o : command.get_options([](const CLI::Option* x) { return x->get_positional(); }))
        names.push_back(o->get_name(true));
    return names;
}

// Returns the error for a missing command, argument or option.
error missing(const CLI::App& app, const CLI::App& command)
{
    if (&command == &app)
        return missing_command_error();
    const std::string help = help_command(app, command);
    const auto options = command.get_options();
    const auto o = std::find_if(options.begin(), options.end(),
                                [](const CLI::Option* x) { return x->get_required() && x->count() == 0; });
    if (o == options.end())
        return {error_kind::bad_input, "command line", "an argument is missing", "see " + help};
    const std::string name = (*o)->get_name();
    if (name.starts_with('-'))
        return {error_kind::bad_input, name, "this option is missing",
                fmt::format("add {} {}, see {}", name, (*o)->get_type_name(), help)};
    return {error_kind::bad_input, "command line", name + " is missing",
            fmt::format("write tactor {} {}, see {}", command.get_name(),
                        fmt::join(list_arguments(command), " "), help)};
}

// Returns the error for an option with too few or too many values. `said` is the parser's text, which begins
// with the option's name.
error value_count_error(const CLI::App& app, const CLI::App& command, const std::string& said)
{
    const std::string name = said.substr(0, said.find_first_of(": "));
    const CLI::Option* o = command.get_option_no_throw(name);
    if (o == nullptr)
        return {error_kind::bad_input, "command line", said, "see " + help_command(app, command)};
    if (o->count() > 1)
        return {error_kind::bad_input, name, "it occurs more than once", "give it once"};
    return {error_kind::bad_input, name, "its value is missing",
            fmt::format("write {} {}, see {}", name, o->get_type_name(), help_command(app, command))};
}

// Returns the error for a value that is not among the option's listed values.
error unlisted_value_error(const CLI::App& command, const std::string& said)
{
    const std::string name = said.substr(0, said.find(':'));
    const CLI::Option& o = *command.get_option(name);
    if (o.count() > 1)
        return {error_kind::bad_input, name, "it occurs more than once", "give it once"};
    return {error_kind::bad_input, name, fmt::format("\"{}\" is unknown", o.results().front()),
            fmt::format("use one of {}", fmt::join(detail::split(o.get_type_name(), '|'), ", "))};
}

// Returns the error for an option that needs another option, or that excludes another option. The parser's
// text contains both names.
error option_pair_error(const CLI::App& app, const CLI::App& command, const std::string& said)
{
    const std::size_t blank = said.find(' ');
    const std::string name = said.substr(0, blank);
    const std::string other = said.substr(said.rfind(' ') + 1);
    if (said.find(" excludes ") != std::string::npos)
        return {error_kind::bad_input, name, "it cannot be combined with " + other, "give one of them"};
    if (said.find(" requires ") != std::string::npos)
        return {error_kind::bad_input, name, "it requires " + other, "add " + other};
    return {error_kind::bad_input, name, "it" + said.substr(blank), "see " + help_command(app, command)};
}

error unexpected_word_error(const CLI::App& app, const CLI::App& command)
{
    const auto left = app.remaining(true);
    const std::string word = left.empty() ? "" : left.front();
    const std::string help = help_command(app, command);
    if (word.starts_with('-')) {
        const std::string name = word.substr(0, word.find('='));
        for (const other_way& o : other_ways)
            if (o.command == command.get_name() && o.name == strip_dashes(name))
                return {error_kind::bad_input, name, fmt::format("tactor {} does not accept it", o.command),
                        o.hint};
        if (const std::string hint = file_hint(command, strip_dashes(name)); !hint.empty())
            return {error_kind::bad_input, name, "only a file can set it", hint};
        const std::string like = name.size() == 2 ? options_by_letter(name[1], command)
                                                  : nearest_option(name, option_names(command));
        return {error_kind::bad_input, name, "no such option",
                like.empty() ? "see " + help : fmt::format("did you mean {}? See {}", like, help)};
    }
    if (&command == &app)
        return unknown_word_error(app, word, "no such command");
    const std::vector<std::string> takes = list_arguments(command);
    return {error_kind::bad_input, word, "it is one argument too many",
            takes.empty() ? fmt::format("leave out this argument: tactor {} accepts none", command.get_name())
                          : fmt::format("give one {}, and quote a name that has blanks",
                                        fmt::join(takes, " and one "))};
}

// Converts an error of the parser to an error that names the option. If the option is unknown, the error
// suggests the most similar option.
error usage_error(const CLI::App& app, const CLI::ParseError& e)
{
    const auto used = app.get_subcommands();
    const CLI::App& command = used.empty() ? app : *used.front();
    if (!app.remaining().empty()) // there are words before the command
        return unexpected_word_error(app, app);
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
        return unexpected_word_error(app, command);
    if (dynamic_cast<const CLI::RequiredError*>(&e) != nullptr)
        return missing(app, command);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&e) != nullptr)
        return value_count_error(app, command, e.what());
    if (dynamic_cast<const CLI::ValidationError*>(&e) != nullptr)
        return unlisted_value_error(command, e.what());
    if (dynamic_cast<const CLI::RequiresError*>(&e) != nullptr ||
        dynamic_cast<const CLI::ExcludesError*>(&e) != nullptr)
        return option_pair_error(app, command, e.what());
    return {error_kind::bad_input, "command line", e.what(), "see " + help_command(app, command)};
}

using words_type = std::vector<std::string>;

// A character that word processors, PDFs and web pages use instead of a character on the keyboard.
struct typeset {
    std::string_view written; // the character in UTF-8
    std::string_view name;
    std::string_view meant; // the keyboard's text, except before a number
};
constexpr std::array typesets{typeset{"\u2010", "a typographic hyphen", "-"},
                              typeset{"\u2011", "a non-breaking hyphen", "-"},
                              typeset{"\u2012", "a figure dash", "-"},
                              typeset{"\u2013", "an en dash", "--"},
                              typeset{"\u2014", "an em dash", "--"},
                              typeset{"\u2212", "a typographic minus sign", "-"},
                              typeset{"\u201c", "an opening quotation mark", "\""},
                              typeset{"\u201d", "a closing quotation mark", "\""},
                              typeset{"\u2018", "an opening quotation mark", "'"},
                              typeset{"\u2019", "a closing quotation mark", "'"}};

bool is_number(std::string_view rest)
{
    return !rest.empty() && ((rest.front() >= '0' && rest.front() <= '9') || rest.front() == '.');
}

// Returns a word with characters from the keyboard only. Sets `found` to the first character that was
// replaced.
std::string replace_typeset(std::string_view word, const typeset*& found)
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
            continue; // this dash stood for two
        // "-D" and numbers begin with a single dash. A dash next to another dash completes "--".
        const bool one = is_number(word) || word.size() == 1 || typed.ends_with('-') || word.starts_with('-');
        typed += dash && one ? "-" : t->meant;
    }
    return typed;
}

// Returns true if typeset characters in a word are probably a mistake. Options and numbers begin with such
// characters, whereas file names may contain them anywhere.
bool may_be_typeset(std::string_view word)
{
    return std::any_of(typesets.begin(), typesets.end(), [&](const typeset& t) {
        const std::size_t at = word.find(t.written);
        return at == 0 || (at != std::string_view::npos &&
                           std::string_view("-= ,").find(word[at - 1]) != std::string_view::npos);
    });
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
        const std::string typed = replace_typeset(word, found);
        const bool quote = found->meant.find('-') == std::string_view::npos;
        return error(error_kind::bad_input, word,
                     fmt::format("it has {}, which is not on the keyboard", found->name),
                     quote ? fmt::format("type {}", found->meant) : "type " + typed);
    }
    return {};
}

// Returns the error for words before the command, or nothing if the first word is rather a misspelt command.
std::optional<error> find_misplaced_command(const words_type& words, const words_type& commands)
{
    const auto is_command = [&](const std::string& w) {
        return std::find(commands.begin(), commands.end(), w) != commands.end();
    };
    const auto at = std::find_if(words.begin(), words.end(), is_command);
    if (at == words.begin() || at == words.end() || !nearest(words.front(), commands).empty())
        return {};
    std::string line = "tactor " + *at;
    for (auto w = words.begin(); w != words.end(); ++w)
        if (w != at)
            line += w->find(' ') == std::string::npos ? " " + *w : fmt::format(" \"{}\"", *w);
    return error(error_kind::bad_input, words.front(), "it comes before the command",
                 "put the command first: " + line);
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

std::optional<error> find_unquoted_path(const words_type& words)
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
    return error(error_kind::bad_input, "--path", "its data have no quotes",
                 fmt::format("quote the path: --path \"{}\"", data));
}

std::optional<error> find_unquoted_name(const words_type& words)
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

std::string help_page(const CLI::App& app, bool whole)
{
    std::string text = describe_command(app);
    if (app.get_parent() == nullptr) {
        CLI::Formatter lists;
        return text + lists.make_groups(&app, CLI::AppFormatMode::Normal) +
               lists.make_subcommands(&app, CLI::AppFormatMode::Normal);
    }
    if (whole) {
        for (const std::string& group : app.get_groups())
            text += list_options(app, group, [&](const CLI::Option& o) { return o.get_group() == group; });
        return text;
    }
    const auto is_own = [&app](const CLI::Option& o) {
        return o.get_group() == own_group && &o != app.get_help_ptr() && &o != app.get_help_all_ptr();
    };
    return text + list_options(app, fmt::format("Options of {}", app.get_name()), is_own) +
           list_options(app, "Often used", is_first) + omitted_options_text(app);
}

void parse_words(CLI::App& app, const words_type& words)
{
    const auto print_help = [&app](bool whole) {
        const auto used = app.get_subcommands();
        say_text(stdout, help_page(used.empty() ? app : *used.front(), whole));
        throw CLI::Success();
    };
    try {
        app.parse(words_type(words.rbegin(), words.rend())); // CLI11 parses a vector from its end
    } catch (const CLI::CallForHelp&) {
        print_help(false);
    } catch (const CLI::CallForAllHelp&) {
        print_help(true);
    } catch (const CLI::CallForVersion& version) {
        fmt::print("{}\n", version.what());
        throw;
    } catch (const CLI::ParseError& e) {
        throw usage_error(app, e);
    }
}

void command_line::parse() const
{
    if (!show)
        return parse_words(*app.get_parent(), words);
    show(app);
    throw CLI::Success();
}

option_help::option_help(const std::string& word)
    : word_(word),
      name_(strip_dashes(word.starts_with(options_prefix) ? word.substr(options_prefix.size()) : word)),
      row_(options::find(name_))
{
    if (row_ != nullptr && (row_->where & options::on_any_command) == 0)
        row_ = nullptr;
    // The help for an option already shows its names in these tables.
    constexpr std::array<std::string_view, 2> tables{"[stroke]", "[[method]]"};
    const std::string keys =
        row_ == nullptr
            ? describe_key(name_)
            : describe_key(name_, std::span(tables).subspan((row_->where & options::in_stroke) != 0 ? 0 : 1));
    text_ = row_ == nullptr ? keys : describe_row(*row_) + (keys.empty() ? "" : "\n" + keys);
    std::replace(name_.begin(), name_.end(), '_', '-');
}

void option_help::add(const CLI::App& command)
{
    for (const CLI::Option* o : command.get_options())
        for (const std::string& name : o->get_lnames()) {
            options_.push_back(name);
            if (name == name_ && (row_ == nullptr || o->get_group() != row_->in))
                text_ += fmt::format("{}tactor {}: {}\n  {}\n", text_.empty() ? "" : "\n", command.get_name(),
                                     append_type("--" + name, o->get_type_name()),
                                     spell_marks(o->get_description()));
            else if (name.find(name_) != std::string::npos)
                similar_.emplace(name, describe_line(*o));
        }
}

std::string option_help::text(const CLI::App& app) const
{
    constexpr std::size_t short_name = 3; // other words contain such a short name by chance
    std::vector<std::string> names = list_key_names();
    const std::set<std::string> similar_keys = find_similar_keys(names, name_);
    const bool lists = (!similar_.empty() || !similar_keys.empty()) && !name_.empty() &&
                       (text_.empty() || name_.size() > short_name);
    std::string text = text_.empty() ? describe_related_keys(name_) : text_;
    if (row_ != nullptr || (!lists && !text.empty()))
        return text;
    if (!lists) {
        names.insert(names.end(), options_.begin(), options_.end());
        throw unknown_word_error(app, word_, "no such command, option or key", names);
    }
    const auto begin_list = [&](const char* what, const char* word) {
        text += fmt::format("{}{} with \"{}\" in their names; tactor help {} explains one:\n",
                            text.empty() ? "" : "\n", what, name_, word);
    };
    if (!similar_.empty())
        begin_list("Options", "OPTION");
    for (const auto& [name, line] : similar_)
        text += line;
    if (!similar_keys.empty()) {
        begin_list("Keys of files", "KEY");
        text += wrap_text("  ", fmt::format("{}", fmt::join(similar_keys, ", ")));
    }
    return text;
}

std::string first_steps()
{
    return "Try these first; they need no sound card:\n"
           "  tactor plan park2016-1                 print which tactor plays when\n"
           "  tactor plot park2016-1 -o stroke.svg   draw the stroke as a picture\n"
           "  tactor serve --http 4003 -D null       draw strokes in a browser, at http://127.0.0.1:4003/\n";
}

error missing_command_error()
{
    return {error_kind::bad_input, "command line", "the command is missing",
            "tactor --help lists the commands"};
}

std::optional<error> find_typing_mistake(const words_type& words, const words_type& commands)
{
    if (auto x = find_typeset(words))
        return x;
    if (auto x = find_misplaced_command(words, commands))
        return x;
    if (auto x = find_unquoted_path(words))
        return x;
    return find_unquoted_name(words);
}

} // namespace tactor::cli
