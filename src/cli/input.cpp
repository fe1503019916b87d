// SPDX-License-Identifier: MIT
#include "cli/input.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/option_words.hpp"
#include "cli/pipes.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> from_environment(const char* name)
{
    const char* v = std::getenv(name);
    if (v == nullptr || *v == '\0')
        return {};
    return v;
}

std::string find_config(const settings& s)
{
    if (s.config_file)
        return *s.config_file;
    if (const auto named = from_environment("TACTOR_CONFIG"))
        return *named;
    std::vector<fs::path> places;
    if (const auto xdg = from_environment("XDG_CONFIG_HOME"))
        places.emplace_back(*xdg);
    else if (const auto home = from_environment("HOME"))
        places.push_back(fs::path(*home) / ".config");
    places.emplace_back("/etc");
    for (const fs::path& p : places) {
        std::error_code ignored;
        if (fs::exists(p / "tactor/tactor.toml", ignored))
            return (p / "tactor/tactor.toml").string();
    }
    return {};
}

bool is_preset(const std::vector<std::string>& presets, const std::string& name)
{
    return std::find(presets.begin(), presets.end(), name) != presets.end();
}

// An array file may bring its own output, amplifier and sync: they belong to that array.
void use_array_file(setup& config, const setup& file)
{
    config.layout = file.layout;
    const auto prefer = [](auto& ours, const auto& theirs) {
        if (theirs)
            ours = theirs;
    };
    if (file.output.pcm) {
        config.output.pcm = file.output.pcm;
        config.output.pcm_at = file.output.pcm_at;
        config.output.pcm_included = true;
    }
    prefer(config.output.rate, file.output.rate);
    // The channel count belongs to the map: one array's count says nothing of another's.
    config.output.channels = file.output.channels;
    prefer(config.output.period_frames, file.output.period_frames);
    prefer(config.output.periods, file.output.periods);
    prefer(config.amplifier, file.amplifier);
    prefer(config.sync, file.sync);
    prefer(config.limits, file.limits);
}

array find_array(const settings& s, option_list& options, environment& e)
{
    setup& config = e.config;
    if (!s.array_name) {
        e.array_file = config.layout ? e.config_name : "";
        return config.layout ? *config.layout : preset_array("palm-3x3");
    }
    if (is_preset(array_presets(), *s.array_name)) {
        config.output.channels.reset();
        return preset_array(*s.array_name);
    }
    if (!fs::exists(*s.array_name) && s.array_name->find_first_of("./") == std::string::npos)
        return preset_array(*s.array_name); // its error lists the presets
    check_readable(*s.array_name);
    const setup file = load_setup(*s.array_name);
    if (!file.layout)
        throw error(errc::bad_input, *s.array_name, "says no [array]", "see tactor.toml(5)");
    options.apply_defaults(file.defaults, *s.array_name);
    use_array_file(config, file);
    e.array_file = *s.array_name;
    return *file.layout;
}

// A configuration's marker channel may meet another file's array.
void check_sync_channel(const environment& e)
{
    if (!e.config.sync || !e.config.sync->channel)
        return;
    for (const tactor_spec& t : e.tactors.tactors)
        if (t.channel == *e.config.sync->channel)
            throw error(errc::bad_input, "[sync] channel",
                        fmt::format("channel {} drives a tactor of {}", t.channel, e.tactors.name),
                        "choose a spare channel");
}

std::vector<stroke> read_one(const std::string& argument)
{
    if (is_preset(stroke_presets(), argument))
        return {preset_stroke(argument)};
    if (argument == "-")
        return load_strokes(STDIN_FILENO, "standard input");
    std::error_code ignored;
    if (!fs::exists(argument, ignored) && argument.find_first_of("./") == std::string::npos)
        return {preset_stroke(argument)}; // its error lists the presets
    check_readable(argument);
    return load_strokes(argument);
}

stroke stroke_of_path(const settings& s, const std::string& data)
{
    const path p = path::from_svg(data);
    const double speed = s.speed_mm_s.value_or(default_speed_mm_s);
    stroke k{"path", trajectory::along(p, s.duration_s.value_or(p.length_mm() / speed)), {}, {}, {}};
    k.speed_mm_s = speed;
    return k;
}

// Times count where the stroke ends up: fitted first.
piece read_piece(const settings& s, const layout& faces, const std::string& argument)
{
    piece p{argument, {}, {}};
    if (s.path_data)
        p.strokes.push_back(stroke_of_path(s, *s.path_data));
    else
        p.strokes = read_one(argument);
    if (s.fit) {
        fitted_strokes fitted = fit_strokes(p.strokes, faces, s.fit_margin_mm);
        p.strokes = std::move(fitted.strokes);
        p.fit = fitted.placed;
    }
    for (stroke& k : p.strokes) {
        if (s.duration_s)
            k.motion = k.motion.with_duration(*s.duration_s);
        else if (s.speed_mm_s && k.motion.length_mm() > 0.0)
            k.motion = k.motion.with_duration(k.motion.length_mm() / *s.speed_mm_s);
    }
    return p;
}

std::vector<std::string> stroke_arguments(const settings& s)
{
    if (s.path_data && !s.strokes.empty())
        throw error(errc::bad_input, "--path", fmt::format("there is also the stroke \"{}\"", s.strokes[0]),
                    "give one of them");
    if (s.path_data)
        return {"--path"};
    if (s.strokes.empty())
        throw error(errc::bad_input, "command line", "no stroke",
                    "give a preset such as park2016-1, a stroke file, - or --path DATA");
    return s.strokes;
}

std::string only_argument(const settings& s)
{
    const auto arguments = stroke_arguments(s);
    if (arguments.size() > 1)
        throw error(errc::bad_input, arguments[1], "one argument too many",
                    "only play takes several strokes");
    return arguments.front();
}

// Which of several strokes it is about, said once: the planner knows its name, but not its number.
error in_piece(const error& x, const std::string& argument, std::size_t number, const std::string& name)
{
    const std::string which =
        name.empty() ? fmt::format("stroke {}", number) : fmt::format("stroke {} \"{}\"", number, name);
    const bool said = x.subject() == "stroke" || x.subject() == fmt::format("stroke \"{}\"", name);
    return said ? error(x.kind(), fmt::format("{}: {}", argument, which), x.why(), x.hint())
                : error(x.kind(), fmt::format("{}: {}: {}", argument, which, x.subject()), x.why(), x.hint());
}

piece plan_piece(const settings& s, const environment& e, const layout& faces, const std::string& argument)
{
    piece p = read_piece(s, faces, argument);
    for (const stroke& k : p.strokes) {
        try {
            p.plans.push_back({make_plan(e.tactors, faces, k, s.plan), k.start_s});
        } catch (const error& x) {
            if (p.strokes.size() == 1)
                throw;
            throw in_piece(in_options(x), argument, p.plans.size() + 1, k.name);
        }
    }
    return p;
}

} // namespace

environment read_environment(settings& s, option_list& options)
{
    environment e;
    e.config_name = find_config(s);
    if (!e.config_name.empty()) {
        check_readable(e.config_name);
        e.config = load_setup(e.config_name);
        options.apply_defaults(e.config.defaults, e.config_name);
    }
    e.tactors = find_array(s, options, e);
    check_sync_channel(e);
    if (s.slope || s.intercept_s) {
        timing_profile& p = s.plan.profile;
        p.slope = s.slope.value_or(p.slope);
        p.intercept_s = s.intercept_s.value_or(p.intercept_s);
        p.max_soa_s = p.intercept_s / (1.0 - p.slope);
    }
    return e;
}

std::vector<piece> plan_pieces(const settings& s, const environment& e)
{
    const layout faces(e.tactors);
    std::vector<piece> pieces;
    for (const std::string& argument : stroke_arguments(s))
        pieces.push_back(plan_piece(s, e, faces, argument));
    return pieces;
}

piece read_one_piece(const settings& s, const layout& faces)
{
    return read_piece(s, faces, only_argument(s));
}

piece plan_one_piece(const settings& s, const environment& e)
{
    return plan_piece(s, e, layout(e.tactors), only_argument(s));
}

score take_score(piece& p, const environment& e, const render_options& render)
{
    return score(e.tactors, std::move(p.plans), render);
}

score make_score(const piece& p, const environment& e, const render_options& render)
{
    return score(e.tactors, p.plans, render);
}

render_options settle_render(const settings& s, const environment& e)
{
    render_options r = s.render;
    r.rate = s.rate.value_or(e.config.output.rate.value_or(48000));
    const unsigned marker = e.config.sync && e.config.sync->channel ? *e.config.sync->channel + 1 : 0;
    r.channels = e.config.output.channels.value_or(std::max(e.tactors.channels(), marker));
    if (marker != 0) {
        r.marker_channel = e.config.sync->channel;
        r.marker_s = e.config.sync->pulse_ms * 1e-3;
    }
    return r;
}

drive_limits settle_limits(const environment& e)
{
    drive_limits l;
    if (!e.config.limits)
        return l;
    l.power_dbfs = e.config.limits->power_dbfs.value_or(l.power_dbfs);
    l.max_drive_s = e.config.limits->max_drive_s.value_or(l.max_drive_s);
    l.window_s = e.config.limits->window_s.value_or(l.window_s);
    return l;
}

} // namespace tactor::cli
