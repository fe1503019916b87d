// SPDX-License-Identifier: MIT
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/option_words.hpp"
#include "cli/usage.hpp"
#include "core/split.hpp"

namespace tactor::cli {
namespace {

constexpr int name_columns = 26;
constexpr const char* own_group = "Options"; // where CLI11 puts what has no group

const options::option* find_row(const CLI::Option& o)
{
    return o.get_lnames().empty() ? nullptr : options::find(o.get_lnames().front());
}

bool is_first(const CLI::Option& o)
{
    const options::option* row = find_row(o);
    return row != nullptr && (row->where & options::shown_first) != 0;
}

std::string with_type(const std::string& name, const std::string& type)
{
    return type.empty() ? name : fmt::format("{} {}", name, type);
}

std::string describe_line(const CLI::Option& o)
{
    const std::string name = with_type(o.get_name(false, true), o.get_type_name());
    return fmt::format("  {:<{}}{}{}\n", name, name_columns,
                       name.size() < name_columns ? "" : fmt::format("\n{:{}}", "", name_columns + 2),
                       spelled(o.get_description()));
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
    std::string text = fmt::format(
        "{}\n  {}\n", with_type(option_name(o), o.what == options::kind::flag ? "" : options::type_text(o)),
        spelled(o.help));
    const auto line = [&text](const char* title, const std::string& said) {
        if (!said.empty())
            text += fmt::format("  {:<18}{}\n", title, said);
    };
    const auto row = [](std::string_view name) { return option_name(*options::find(name)); };
    if (o.what == options::kind::number || o.what == options::kind::whole)
        line("Range:", spelled(options::range_text(o)));
    line("Not beside:", o.rival.empty() ? "" : row(o.rival));
    line("Needs:", spelled(fmt::format("{}", fmt::join(detail::split(o.needs, '|'), " or "))));
    line("Commands:", places_text(options::command_names(), o.where));
    const bool is_default = (o.where & options::in_defaults) != 0;
    line("[defaults]:", is_default ? options::dashed(o) : "");
    line("Stroke files:", (o.where & options::in_stroke) != 0 ? std::string(o.field_name()) : "");
    line("[[method]]:", (o.where & options::in_method) != 0 ? std::string(o.name) : "");
    line("JSON-RPC:", (o.where & options::by_client) != 0 ? fmt::format("options.{}", o.name) : "");
    line("OSC:", (o.where & options::by_client) != 0 ? fmt::format("{}=", o.name) : "");
    const std::string python = places_text(python_names, o.where);
    line("Python:", python.empty() ? "" : fmt::format("{} of {}", o.name, python));
    return text;
}

// Returns all options of all commands by name, each once, with its line of --help.
std::map<std::string, std::string> list_options(const CLI::App& app)
{
    std::map<std::string, std::string> all;
    for (const CLI::App* command : app.get_subcommands({}))
        for (const CLI::Option* o : command->get_options())
            for (const std::string& name : o->get_lnames())
                all.emplace(name, describe_line(*o));
    return all;
}

/// Writes --help so that it fits a screen: the options that a command alone has and those that most people
/// need, with their meaning; of the others the names. --help-all explains them all.
class help_page : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override
    {
        if (mode == CLI::AppFormatMode::Sub)
            return CLI::Formatter::make_help(app, name, mode);
        const std::string head =
            make_description(app) + make_usage(app, name) + make_positionals(app) + make_footer(app) + '\n';
        if (app->get_parent() == nullptr)
            return head + make_groups(app, mode) + make_subcommands(app, mode);
        if (mode == CLI::AppFormatMode::All)
            return head + describe_groups(*app);
        return head +
               describe(*app, fmt::format("Options of {}", app->get_name()),
                        [&](const CLI::Option& o) {
                            return o.get_group() == own_group && &o != app->get_help_ptr() &&
                                   &o != app->get_help_all_ptr();
                        }) +
               describe(*app, "Often used", is_first) + name_groups(*app);
    }

    std::string make_usage(const CLI::App* app, std::string /*name*/) const override
    {
        if (app->get_parent() == nullptr)
            return "\nUsage: tactor COMMAND [OPTIONS]\n";
        std::string text = fmt::format("\nUsage: tactor {} [OPTIONS]", app->get_name());
        for (const CLI::Option* o : positionals(*app))
            text += o->get_required() ? " " + shown_name(*o) : fmt::format(" [{}]", shown_name(*o));
        return text + '\n';
    }

    std::string make_positionals(const CLI::App* app) const override
    {
        std::string text;
        for (const CLI::Option* o : positionals(*app))
            text += fmt::format("\n  {:<12}{}\n", o->get_name(true), o->get_description());
        return text;
    }

    std::string make_footer(const CLI::App* app) const override
    {
        return fmt::format("\nExamples:\n  {}\n", fmt::join(detail::split(app->get_footer(), '\n'), "\n  "));
    }

private:
    static std::vector<const CLI::Option*> positionals(const CLI::App& app)
    {
        return app.get_options([](const CLI::Option* o) { return o->get_positional(); });
    }

    static std::string shown_name(const CLI::Option& positional)
    {
        return positional.get_name(true) + (positional.get_expected_max() > 1 ? "..." : "");
    }

    static std::string describe(const CLI::App& app, const std::string& title,
                                const std::function<bool(const CLI::Option&)>& shows)
    {
        std::string lines;
        for (const CLI::Option* o : app.get_options())
            if (o->nonpositional() && shows(*o))
                lines += describe_line(*o);
        return lines.empty() ? "" : fmt::format("{}:\n{}\n", title, lines);
    }

    static std::string describe_groups(const CLI::App& app)
    {
        std::string all;
        for (const std::string& group : app.get_groups())
            all += describe(app, group, [&](const CLI::Option& o) { return o.get_group() == group; });
        return all;
    }

    static std::string name_groups(const CLI::App& app)
    {
        std::string lists;
        for (const std::string& group : app.get_groups()) {
            std::vector<std::string> names;
            for (const CLI::Option* o : app.get_options())
                if (o->nonpositional() && o->get_group() == group && group != own_group && !is_first(*o))
                    names.push_back("--" + o->get_lnames().front());
            if (!names.empty())
                lists += fmt::format("  {:<12}{}\n", group, fmt::join(names, " "));
        }
        if (lists.empty())
            return {};
        return fmt::format("More, by group:\n{}\ntactor help OPTION explains one option, "
                           "tactor {} --help-all explains all.\n",
                           lists, app.get_name());
    }
};

} // namespace

void use_help_pages(CLI::App& app)
{
    app.formatter(std::make_shared<help_page>());
    app.set_help_flag("-h,--help", "print the most important options and exit");
    app.set_help_all_flag("--help-all", "print all options and exit");
}

std::string describe_options(const CLI::App& app, std::string_view given)
{
    const std::string_view name = bare_name(given);
    const options::option* row = options::find(name);
    if (row != nullptr && (row->where & options::on_any_command) == 0)
        row = nullptr;
    std::string text = row != nullptr ? describe_row(*row) : "";
    for (const CLI::App* command : app.get_subcommands({})) {
        const CLI::Option* o = command->get_option_no_throw(fmt::format("--{}", name));
        if (o != nullptr && (row == nullptr || o->get_group() != to_string(row->in)))
            text += fmt::format("tactor {}: {}\n  {}\n", command->get_name(),
                                with_type(fmt::format("--{}", name), o->get_type_name()),
                                spelled(o->get_description()));
    }
    if (!text.empty())
        return text;
    for (const auto& [known, line] : list_options(app))
        if (known.find(name) != std::string::npos)
            text += line;
    if (text.empty() || name.empty())
        throw no_such_command(app, std::string(given));
    return fmt::format("Options with \"{}\" in their names; tactor help OPTION explains one:\n{}", name,
                       text);
}

std::string first_steps()
{
    return "Try these first; they need no sound card:\n"
           "  tactor plan park2016-1                 print which tactor plays when\n"
           "  tactor plot park2016-1 -o stroke.svg   draw the stroke as a picture\n"
           "  tactor serve --http 4003 -D null       draw strokes in a browser, at http://127.0.0.1:4003/\n";
}

} // namespace tactor::cli
