// SPDX-License-Identifier: MIT
#include "cli/input.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "cli/option_words.hpp"
#include "cli/warnings.hpp"
#include "core/start_times.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

std::vector<stroke> read_one(const settings& s, const environment& e, const std::string& argument)
{
    if (e.plans.contains(argument))
        throw error(error_kind::bad_input, shown_name(argument), "it is a plan",
                    "give the stroke, which is planned here");
    if (session::is_preset(stroke_presets(), argument))
        return {preset_stroke(argument)};
    if (argument == "-")
        return e.standard_input;
    std::error_code ignored;
    if (!fs::exists(argument, ignored) && argument.find_first_of("./") == std::string::npos) {
        const auto& shapes = stroke_shapes();
        if (std::find(shapes.begin(), shapes.end(), argument) != shapes.end())
            throw error(error_kind::bad_input, argument, "it is a shape, not a preset",
                        fmt::format("--shape {}", argument));
        return {preset_stroke(argument)}; // its error lists the presets
    }
    session::check_readable(argument);
    return load_strokes(argument, s.intensity_max.value_or(1.0));
}

// Fits the strokes that a file fits: the margin is the file's, not an option.
void fit_by_file(const std::string& file, piece& p, const layout& faces)
{
    try {
        p.strokes = apply_fits(std::move(p.strokes), faces);
    } catch (const error& e) {
        if (e.field() != "margin_mm")
            throw;
        throw e.reworded(file, fmt::format("fit_margin_mm: {}", e.why()), e.hint());
    }
}

piece read_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument)
{
    piece p{argument};
    if (s.path_data)
        p.strokes = session::read_strokes("path", *s.path_data, argument, s);
    else if (s.shape)
        p.strokes = session::read_strokes("stroke", *s.shape, argument, s);
    else
        p.strokes = read_one(s, e, argument);
    fit_by_file(shown_name(argument), p, faces);
    session::place_strokes(p, faces, s);
    return p;
}

// Puts `from` before the subject of an error, or in its place where the subject is the stroke of that name.
error put_before(const error& x, const std::string& from, const std::string& name)
{
    const bool said = x.subject() == "stroke" || x.subject() == fmt::format("stroke \"{}\"", name);
    return x.reworded(said ? from : fmt::format("{}: {}", from, x.subject()), x.why(), x.hint());
}

// Adds the number of the stroke that an error is about: the planner knows only its name.
error in_piece(const error& x, const std::string& argument, std::size_t number, const std::string& name)
{
    if (x.place().line != 0)
        return x; // its line says which
    const std::string quoted = name.empty() ? "" : fmt::format(" \"{}\"", name);
    return put_before(x, fmt::format("{}: stroke {}{}", shown_name(argument), number, quoted), name);
}

// --path and --shape NAME stand for a STROKE.
bool is_option(const std::string& argument)
{
    return argument.starts_with("--");
}

// Returns the name of an argument's only stroke where the file gives none.
std::string default_name(const std::string& argument)
{
    if (is_option(argument))
        return argument.substr(argument.find_first_not_of('-', argument.rfind(' ') + 1));
    const bool file = argument != "-" && !session::is_preset(stroke_presets(), argument);
    return file ? fs::path(argument).stem().string() : shown_name(argument);
}

// A file's only stroke: which file, for the planner knows the stroke's name at most. What the command line or
// a preset says is known without.
error in_file(const error& x, const std::string& argument)
{
    const bool about_it = x.subject() == "stroke" || x.subject().starts_with("stroke \"");
    const bool file = !is_option(argument) && !session::is_preset(stroke_presets(), argument);
    return about_it && file ? put_before(x, shown_name(argument), default_name(argument)) : x;
}

// A plan comes with its strokes; those that are read as strokes are not planned yet.
piece open_argument(const settings& s, const environment& e, const layout& faces, const std::string& argument)
{
    const auto planned = e.plans.find(argument);
    if (planned == e.plans.end())
        return read_piece(s, e, faces, argument);
    const files::plan_file& f = planned->second;
    files::check_same_array(argument, f.tactors, e.tactors);
    piece p{f.made, true};
    p.name = argument;
    return p;
}

bool has_own_carrier(const stroke& s)
{
    return s.sound.carrier_hz || !s.sound.carrier_profile.empty();
}

// Calls f(i) for each stroke, and says of which it is that it throws.
template <class F>
void for_each_stroke(const piece& p, F f)
{
    progress_line line(shown_name(p.name));
    for (std::size_t i = 0; i < p.strokes.size(); ++i) {
        line.update(i, p.strokes.size());
        try {
            f(i);
        } catch (const error& x) {
            throw of_stroke(x, p, i);
        }
    }
}

// Each begins in the piece, whether its samples are wanted or not.
void check_starts(const piece& p)
{
    detail::start_times times;
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const placed_plan& q = p.plans[i];
        try {
            times.start(q.start_s, q.anchor);
        } catch (const error& x) {
            throw i < p.strokes.size() ? of_stroke(x, p, i) : x;
        }
        times.lasts(q.plan.total_s);
    }
}

} // namespace

std::vector<std::string> stroke_arguments(const settings& s)
{
    const std::string option = s.path_data ? "--path" : s.shape ? "--shape " + *s.shape : "";
    if (s.path_data && s.shape)
        throw error(error_kind::bad_input, option, "there is also --shape " + *s.shape, "give one of them");
    if (!option.empty() && !s.strokes.empty())
        throw error(error_kind::bad_input, option,
                    fmt::format("there is also the stroke \"{}\"", s.strokes[0]), "give one of them");
    if (!option.empty())
        return {option};
    if (s.strokes.empty())
        throw error(error_kind::bad_input, "command line", "no stroke",
                    "give a preset such as park2016-1, a stroke file, -, --path DATA or --shape circle");
    return s.strokes;
}

std::string shown_name(const std::string& argument)
{
    return argument == "-" ? "standard input" : argument;
}

std::string name_stroke(const piece& p, std::size_t i)
{
    const std::string argument = shown_name(p.name);
    const std::string& own = p.strokes[i].name;
    if (p.from_plan)
        return own;
    return p.strokes.size() == 1 && own == default_name(p.name) ? argument
                                                                : fmt::format("{}: {}", argument, own);
}

error of_stroke(const error& x, const piece& p, std::size_t i)
{
    const stroke& s = p.strokes[i];
    const std::string_view what = x.subject();
    const bool carrier = has_own_carrier(s) && (what == "carrier_hz" || what == "carrier_profile");
    const bool wave = s.sound.wave && what == "waveform";
    const bool start = x.field() == "start_s";
    const source_place& at = carrier ? s.places.carrier : wave ? s.places.wave : s.places.start;
    if ((carrier || wave || start) && at.line != 0)
        return x.reworded(at.text(), fmt::format("{}: {}", start ? "start_s" : what, x.why()), x.hint())
            .with_place(at);
    // Its own: not what [defaults] says.
    const error about =
        carrier || wave ? x.reworded("stroke", fmt::format("{}: {}", what, x.why()), x.hint()).with_field("")
                        : x;
    return p.strokes.size() == 1 ? in_file(about, p.name)
                                 : in_piece(in_options(about), p.name, i + 1, s.name);
}

std::vector<piece> open_pieces(const settings& s, const environment& e, const layout& faces)
{
    std::vector<piece> pieces;
    for (const std::string& argument : stroke_arguments(s))
        pieces.push_back(open_argument(s, e, faces, argument));
    return pieces;
}

piece open_one_piece(const settings& s, const environment& e, const layout& faces)
{
    return open_argument(s, e, faces, stroke_arguments(s).front());
}

piece read_one_piece(const settings& s, const environment& e, const layout& faces)
{
    return read_piece(s, e, faces, stroke_arguments(s).front());
}

piece plan_one_piece(const settings& s, const environment& e)
{
    const layout faces(e.tactors);
    piece p = open_one_piece(s, e, faces);
    if (p.plans.empty())
        for_each_stroke(p, [&](std::size_t i) { session::plan_stroke(p, i, e.tactors, faces, s); });
    check_starts(p);
    return p;
}

score plan_and_score(piece& p, const settings& s, const environment& e, const layout& faces,
                     const render_options& render)
{
    score_builder made(e.tactors, render);
    if (p.plans.empty())
        for_each_stroke(p, [&](std::size_t i) {
            const stroke& k = p.strokes[i];
            if (s.compensate)
                made.add(make_compensated_plan(e.tactors, faces, k, s.plan, s.low_speed).plan, k.start_s,
                         k.anchor);
            else
                made.add(faces, k, s.plan);
        });
    for (placed_plan& q : std::exchange(p.plans, {}))
        made.add(std::move(q.plan), q.start_s, q.anchor);
    return made.take();
}

score make_score(const piece& p, const environment& e, const render_options& render)
{
    score_builder made(e.tactors, render);
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        const placed_plan& q = p.plans[i];
        try {
            made.add(q.plan, q.start_s, q.anchor);
        } catch (const error& x) {
            if (i < p.strokes.size())
                throw of_stroke(x, p, i);
            throw;
        }
    }
    return made.take();
}

} // namespace tactor::cli
