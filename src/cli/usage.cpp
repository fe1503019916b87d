// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

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

// The option that a name is a slip of, or nothing. Of a short name one letter makes another word: then its
// beginning must agree ("seed" is not "speed", "sped" may be).
std::string nearest_option(const std::string& given, const std::vector<std::string>& names)
{
    constexpr std::size_t short_name = 4;
    const std::string bare(bare_name(given));
    const std::string like = nearest(bare, names);
    if (like.empty() || (bare.size() <= short_name && bare.substr(0, 2) != like.substr(0, 2)))
        return {};
    return "--" + like;
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

error unknown(const CLI::App& app, const CLI::App& command)
{
    const auto left = app.remaining(true);
    const std::string given = left.empty() ? "" : left.front();
    const std::string help = help_command(app, command) + " lists them";
    if (given.starts_with('-')) {
        const std::string name = given.substr(0, given.find('='));
        const std::string like = nearest_option(name, option_names(command));
        return {error_kind::bad_input, name, "no such option",
                like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
    }
    if (&command == &app) {
        std::vector<std::string> names;
        for (const CLI::App* c : app.get_subcommands({}))
            names.push_back(c->get_name());
        const std::string like = nearest(given, names);
        return {error_kind::bad_input, given, "no such command",
                like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
    }
    return {error_kind::bad_input, given, "one argument too many", help};
}

} // namespace

error no_command()
{
    return {error_kind::bad_input, "command line", "no command", "tactor --help lists them"};
}

error usage_error(const CLI::App& app, const CLI::ParseError& e)
{
    const CLI::App& command = used_command(app);
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
        return unknown(app, command);
    if (app.get_subcommands().empty() && !app.remaining().empty())
        return unknown(app, app);
    if (dynamic_cast<const CLI::RequiredError*>(&e) != nullptr)
        return missing(app, command);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&e) != nullptr)
        return miscounted(app, command, e.what());
    return {error_kind::bad_input, "command line", e.what(), help_command(app, command)};
}

} // namespace tactor::cli
