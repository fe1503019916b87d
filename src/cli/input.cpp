// SPDX-License-Identifier: MIT
#include "cli/input.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "options/resolve.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

// Returns true if the argument is an option that replaces a STROKE: --path, or --shape NAME.
bool is_option(const std::string& argument)
{
    return argument.starts_with("--");
}

// Returns the name of a file's only stroke if the file does not name it.
std::string default_name(const std::string& argument)
{
    if (is_option(argument))
        return argument.substr(argument.find_first_not_of('-', argument.rfind(' ') + 1));
    const bool file = argument != "-" && !session::is_preset(stroke_presets(), argument);
    return file ? fs::path(argument).stem().string() : shown_name(argument);
}

// Rewords an error about a value from the stroke itself, because neither an option nor a value of [defaults]
// is wrong. The error names the place in the stroke's file. If this place is unknown, it names the stroke.
error reword_stroke_error(const error& x, const stroke& s)
{
    const bool over_time = !s.sound.carrier_times.empty();
    const bool has_carrier = s.sound.carrier_hz || !s.sound.carrier_profile.empty() || over_time;
    const bool carrier = has_carrier && (x.field() == "carrier_hz" || x.field() == "carrier_profile");
    const bool wave = s.sound.wave && x.field() == "waveform";
    if (!carrier && !wave && x.field() != "start_s")
        return x;
    const source_place& at = carrier ? s.places.carrier : wave ? s.places.wave : s.places.start;
    const std::string why = fmt::format("{}: {}", carrier && over_time ? "carrier_hz" : x.field(), x.why());
    if (at.line != 0)
        return x.reworded(at.text(), why, x.hint()).with_place(at);
    return carrier || wave ? x.reworded("stroke", why, x.hint()).with_field("") : x;
}

// Calls work(next). The function `next` sets the number of the current stroke. If work() throws, the error
// names the current stroke.
template <class F>
auto name_stroke_in_errors(const piece& p, F work)
{
    const std::string name = shown_name(p.name);
    const std::size_t count = std::max(p.strokes.size(), p.plans.size());
    progress_line line(name);
    std::size_t at = count;
    try {
        return work([&](std::size_t i) {
            at = i;
            if (i < count)
                line.update(i, count);
        });
    } catch (const error& x) {
        throw add_stroke_to_error(x, p, at);
    }
}

// Returns the source that a STROKE argument stands for.
session::source find_source(const settings& s, const environment& e, const std::string& argument)
{
    if (const auto planned = e.plans.find(argument); planned != e.plans.end()) {
        files::check_same_array(argument, planned->second.tactors, e.tactors);
        return planned->second.made;
    }
    if (is_wav_argument(argument)) {
        options::refuse_stroke_options(s, argument);
        return session::samples_file{argument};
    }
    if (s.path_data)
        return session::path_data{*s.path_data};
    if (s.shape)
        return session::stroke_name{*s.shape};
    if (const auto preset = find_preset(argument))
        return session::stroke_name{preset->name};
    if (argument == "-")
        return e.standard_input;
    session::check_readable(argument);
    return session::stroke_file{argument};
}

} // namespace

bool has_stroke_argument(const settings& s)
{
    return s.path_data || s.shape || !s.strokes.empty();
}

std::vector<std::string> stroke_arguments(const settings& s)
{
    const std::string option = s.path_data ? "--path" : s.shape ? "--shape " + *s.shape : "";
    if (s.path_data && s.shape)
        refuse_option(option, "it cannot be combined with --shape " + *s.shape, "give one of them");
    if (!option.empty() && !s.strokes.empty())
        refuse_option(option, fmt::format("it cannot be combined with the stroke \"{}\"", s.strokes[0]),
                      "give one of them");
    if (!option.empty())
        return {option};
    if (s.strokes.empty())
        throw error(error_kind::bad_input, "command line", "the stroke is missing",
                    "give a preset such as park2016-1, a stroke file, -, --path DATA or --shape circle");
    return s.strokes;
}

std::optional<stroke> find_preset(const std::string& argument)
{
    std::error_code ignored;
    const bool is_file =
        argument == "-" || argument.find_first_of("./") != std::string::npos || fs::exists(argument, ignored);
    if (is_file && !session::is_preset(stroke_presets(), argument))
        return {};
    const auto& shapes = stroke_shapes();
    if (std::find(shapes.begin(), shapes.end(), argument) != shapes.end())
        throw error(error_kind::bad_input, argument, "it is a shape, not a preset",
                    fmt::format("use --shape {}", argument));
    return preset_stroke(argument); // throws an error that lists the presets
}

bool is_wav_argument(std::string_view argument)
{
    const std::string_view end = argument.substr(argument.size() - std::min<std::size_t>(argument.size(), 4));
    return end.size() == 4 && to_lower_case(std::string(end)) == ".wav";
}

void refuse_samples(const std::string& argument)
{
    if (is_wav_argument(argument))
        throw error(error_kind::bad_input, argument, "it has samples, but no stroke to plan",
                    "use {command:play} or {command:render}");
}

std::string shown_name(const std::string& argument)
{
    return argument == "-" ? "standard input" : make_printable(argument);
}

std::string format_stroke_name(const piece& p, std::size_t i, const environment& e)
{
    const std::string argument = shown_name(p.name);
    const std::string& own = p.strokes[i].name;
    if (e.plans.contains(p.name))
        return make_printable(own);
    return p.strokes.size() == 1 && own == default_name(p.name)
               ? argument
               : fmt::format("{}: {}", argument, make_printable(own));
}

error add_stroke_to_error(const error& x, const piece& p, std::size_t i)
{
    if (i >= p.strokes.size())
        return x;
    const std::string& name = p.strokes[i].name;
    const error own = reword_stroke_error(x, p.strokes[i]);
    const bool is_alone = p.strokes.size() == 1;
    const bool is_about_stroke = own.subject() == "stroke" || own.subject().starts_with("stroke \"");
    const bool is_file = !is_option(p.name) && !session::is_preset(stroke_presets(), p.name);
    if (own.place().line != 0 || (is_alone && !(is_about_stroke && is_file)))
        return own;
    // The planner knows only the name of the stroke. Add the file before the name, and the number of the
    // stroke if there are several.
    std::string from = shown_name(p.name);
    if (!is_alone)
        from += fmt::format(": stroke {}", i + 1) + (name.empty() ? "" : fmt::format(" \"{}\"", name));
    const error e = reword_as_options(own);
    const std::string called = fmt::format("stroke \"{}\"", is_alone ? default_name(p.name) : name);
    const bool is_whole = e.subject() == "stroke" || e.subject() == called;
    return e.reworded(is_whole ? from : fmt::format("{}: {}", from, e.subject()), e.why(), e.hint());
}

piece open_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument)
{
    piece p = session::read_piece(find_source(s, e, argument), shown_name(argument), faces, s);
    p.name = argument;
    return p;
}

piece plan_one_piece(const settings& s, const environment& e)
{
    const layout faces(e.tactors);
    refuse_samples(stroke_arguments(s).front());
    piece p = open_piece(s, e, faces, stroke_arguments(s).front());
    name_stroke_in_errors(p, [&](const auto& next) { session::plan_piece(p, e.tactors, faces, s, next); });
    return p;
}

score plan_and_score(piece& p, const settings& s, const environment& e, const layout& faces,
                     const render_options& render)
{
    return name_stroke_in_errors(
        p, [&](const auto& next) { return session::make_score(p, e.tactors, faces, s, render, next); });
}

score make_score(const piece& p, const environment& e, const render_options& render)
{
    return name_stroke_in_errors(
        p, [&](const auto& next) { return session::make_score(p, e.tactors, render, next); });
}

} // namespace tactor::cli
