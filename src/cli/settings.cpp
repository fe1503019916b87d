// SPDX-License-Identifier: MIT
#include "cli/settings.hpp"

#include <algorithm>
#include <array>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "options/option.hpp"
#include "options/resolve.hpp"

namespace tactor::cli {
namespace {

void add_table_option(CLI::App& command, settings& into, const options::option& o)
{
    const std::string name =
        fmt::format("{}--{}", o.letter.empty() ? "" : fmt::format("-{},", o.letter), options::dashed(o));
    // This text still contains marks for option names. They are replaced when the page of help is printed.
    const std::string help(o.help);
    CLI::Option* added = nullptr;
    if (o.what == options::kind::flag)
        added = command.add_flag_function(
            name, [&into, &o](std::int64_t n) { options::give(into, o, n > 0); }, help);
    else
        added =
            command
                .add_option_function<std::string>(
                    name,
                    [&into, &o](const std::string& t) { options::give(into, o, options::read_text(o, t)); },
                    help)
                ->type_name_fn([&o] { return options::type_text(o); });
    added->group(std::string(o.in));
}

constexpr std::array own_words{options::own_word{"command:plan", "tactor plan STROKE --format json"},
                               options::own_word{"array=none", "leave out --array"},
                               options::own_word{"force=true", "--force"},
                               options::own_word{"wider=true", "leave out the number of channels"},
                               options::own_word{"participants", "--participants"},
                               options::own_word{"exclude", "--exclude"}};

std::string spell_option(const options::option& o, std::string_view value)
{
    if ((o.where & options::file_only) != 0)
        return fmt::format("{}{}{} in [defaults]", options::dashed(o), value.empty() ? "" : " = ", value);
    if (value.empty() || o.what == options::kind::flag)
        return option_name(o);
    return fmt::format("{} {}", o.letter.empty() ? option_name(o) : fmt::format("-{}", o.letter), value);
}

constexpr options::spelling by_tool{.write = spell_option, .own = own_words};

} // namespace

void begin_group(CLI::App& command, const std::string& heading)
{
    command.option_defaults()->group(heading);
}

void add_force_option(CLI::App& command, bool& into)
{
    command.add_flag(
        "--force", into,
        "replace a file that tactor did not write, or that somebody changed since; never an input");
}

void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help)
{
    into = names.front();
    command.add_option("--format", into, help)
        ->type_name(fmt::format("{}", fmt::join(names, "|")))
        ->check(CLI::IsMember(names).description(""));
}

CLI::Option* add_text_option(CLI::App& command, const std::string& names, const std::string& type,
                             const std::string& help, const std::function<void(const std::string&)>& take)
{
    return command.add_option_function<std::string>(names, take, help)->type_name(type);
}

std::size_t choose(std::string_view option, const std::string& text, const std::vector<std::string>& names)
{
    const auto at = std::find(names.begin(), names.end(), text);
    if (at == names.end())
        refuse_option(option, fmt::format("\"{}\" is unknown", text),
                      fmt::format("use one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(at - names.begin());
}

void refuse_option(std::string_view option, const std::string& why, std::string_view hint)
{
    throw error(error_kind::bad_input, option, why, hint);
}

settings& add_options(command_line& line, std::uint64_t place)
{
    line.values.place = place;
    for (const options::option& o : options::all())
        if ((o.where & place) != 0 && (o.where & options::file_only) == 0)
            add_table_option(line.app, line.values, o);
    return line.values;
}

std::string find_stream_option(const settings& s)
{
    for (const options::option& o : options::all())
        if (s.gives(o) && (o.in == options::group::real_time || o.name == "no_gpio" || o.name == "verbose" ||
                           o.name == "log"))
            return option_name(o);
    return {};
}

void add_stroke_argument(command_line& line, int most, const std::string& name)
{
    auto* strokes =
        line.app.add_option(name, line.values.strokes,
                            "preset (park2016-1 ... park2016-4; wave-2x4 and round-2x4 on palm-2x4), "
                            "file (.toml, .csv, .svg, .tact, .haptic, .ahap; .json: a plan), or - for such a "
                            "file on standard input");
    strokes->type_name("");
    strokes->expected(1, most)->allow_extra_args(most > 1);
}

void add_picture_options(CLI::App& command, picture_options& into, const std::string& usual_width)
{
    begin_group(command, "Picture");
    add_text_option(command, "--width", "MM", fmt::format("width of the picture (default {})", usual_width),
                    [&into](const std::string& t) {
                        into.width_mm = options::parse_number(
                            "--width", t, {plot::least_width_mm, plot::most_width_mm}, "mm");
                    });
    add_text_option(command, "--dpi", "N", "resolution of a PNG (default 300)",
                    [&into](const std::string& t) {
                        into.dpi = static_cast<unsigned>(
                            options::parse_whole("--dpi", t, {plot::least_dpi, plot::most_dpi}, "dpi"));
                    });
    command.add_option("--title", into.title, "title of the picture; none leaves the heading out")
        ->type_name("TEXT|none");
    begin_group(command);
    add_force_option(command, into.force);
}

std::string option_name(const options::option& o)
{
    return "--" + options::dashed(o);
}

std::string spell_marks(std::string_view marked)
{
    return options::spell(marked, by_tool);
}

error reword_as_options(const error& e)
{
    return options::spell(e, by_tool);
}

} // namespace tactor::cli
