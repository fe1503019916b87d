// SPDX-License-Identifier: MIT
#include "session/environment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/setup_layers.hpp"
#include "files/text_file.hpp"
#include "options/resolve.hpp"
#include "rt/system_files.hpp"
#include "session/piece.hpp"
#include "session/process.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

namespace fs = std::filesystem;

constexpr const char* usual_array = "palm-3x3";

std::string find_config(const settings& s)
{
    if (s.config_file)
        return *s.config_file;
    if (std::string named = rt::variable("TACTOR_CONFIG"); !named.empty())
        return named;
    std::vector<fs::path> places;
    if (const std::string xdg = rt::variable("XDG_CONFIG_HOME"); !xdg.empty())
        places.emplace_back(xdg);
    else if (const std::string home = rt::variable("HOME"); !home.empty())
        places.push_back(fs::path(home) / ".config");
    places.emplace_back("/etc");
    for (const fs::path& p : places) {
        std::error_code ignored;
        if (fs::exists(p / "tactor/tactor.toml", ignored))
            return (p / "tactor/tactor.toml").string();
    }
    return {};
}

// Returns the tactor at a place, or null.
const tactor_spec* find_tactor(const array& a, point at)
{
    const auto found = std::find_if(a.tactors.begin(), a.tactors.end(), [at](const tactor_spec& t) {
        return distance_mm(t.position, at) <= same_place_mm;
    });
    return found == a.tactors.end() ? nullptr : &*found;
}

// Returns true for arrays with tactors at the same places, whatever their numbers.
bool have_same_places(const array& a, const array& b)
{
    return a.tactors.size() == b.tactors.size() &&
           std::all_of(a.tactors.begin(), a.tactors.end(),
                       [&b](const tactor_spec& t) { return find_tactor(b, t.position) != nullptr; });
}

// Lowers the limits of an array's tactors to those that another array has at the same places. Errors then
// name the other array's file.
void lower_limits(array& a, const array& other)
{
    for (tactor_spec& t : a.tactors)
        if (const tactor_spec* o = find_tactor(other, t.position); o != nullptr && o->max_dbfs < t.max_dbfs) {
            t.max_dbfs = o->max_dbfs;
            t.limit_where = o->where;
        }
}

// Adds the contents of an array file. Its output, amplifier and sync settings replace the configuration's,
// because they belong to its array. The lower of two ceilings applies, also for a tactor, where both arrays
// have the same places.
void use_array_file(setup& config, const setup& file)
{
    const std::optional<array> configured = std::exchange(config.array, file.array);
    if (configured && have_same_places(*configured, *file.array))
        lower_limits(*config.array, *configured);
    config.calibration = file.calibration;
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
    // The number of channels belongs to the array: the number for one array has no meaning for another.
    config.output.channels = file.output.channels;
    prefer(config.output.period_frames, file.output.period_frames);
    prefer(config.output.periods, file.output.periods);
    prefer(config.amplifier, file.amplifier);
    prefer(config.texture, file.texture);
    prefer(config.sync, file.sync);
    config.limits = detail::join_limits(config.limits, file.limits);
    static_cast<void>(
        options::read_serve(config.serve)); // so that neither file hides the errors of the other
    static_cast<void>(options::read_serve(file.serve));
    detail::join_serve(config.serve, file.serve);
    for (const written_value& d : file.defaults)
        detail::add_default(config.defaults, d);
}

// Reads standard input, once. The first character shows if it is a plan.
void read_standard_input(const settings& s, environment& e)
{
    constexpr const char* name = "standard input";
    detail::note_input("/dev/fd/0");
    const detail::whole_text text = [] {
        try {
            return detail::read_text(STDIN_FILENO, name, detail::max_stroke_bytes);
        } catch (const error& x) {
            if (x.os_code() != 0)
                refuse_standard_input(x.os_code());
            throw;
        }
    }();
    if (!files::holds_plans(text)) {
        e.standard_input = parse_strokes(text, name, s.intensity_max.value_or(1.0), s.position.value_or(""));
        return;
    }
    options::refuse_planning_options(s, name);
    e.plans.emplace("-", files::read_plans(text, name));
}

// Reads the plans among the STROKE arguments, and standard input. Returns the first plan, or null.
const files::plan_file* read_plans(const settings& s, environment& e)
{
    if (std::find(s.strokes.begin(), s.strokes.end(), "-") != s.strokes.end())
        read_standard_input(s, e);
    const files::plan_file* first = nullptr;
    for (const std::string& argument : s.strokes) {
        if (files::is_plan_file(argument) && !e.plans.contains(argument)) {
            options::refuse_planning_options(s, argument);
            check_readable(argument);
            e.plans.emplace(argument, files::load_plans(argument));
        }
        if (const auto plan = e.plans.find(argument); first == nullptr && plan != e.plans.end())
            first = &plan->second;
    }
    return first;
}

// Sets the sound options with which a plan was first rendered, except those that the user set. Ignores
// [defaults].
void use_plan_sound(const files::plan_file& f, settings& s)
{
    options::option_values kept;
    kept.render = f.render;
    kept.rate = f.render.rate;
    for (const options::option& o : options::all())
        if (o.is_sound() && !s.gives(o) && (o.rival.empty() || !s.gives(o.rival)))
            o.to.set(s, o.to.get(kept));
    s.render.marker_channel = f.render.marker_channel;
    s.render.marker_s = f.render.marker_s;
}

// Returns a preset. The error for another name lists the presets.
array named_array(const std::string& name)
{
    try {
        return preset_array(name);
    } catch (const error& e) {
        throw e.reworded(e.subject(), e.why(), fmt::format("{}; or name a file", e.hint()));
    }
}

// Returns true for the name of a preset, not of a file.
bool is_preset_name(const std::string& name)
{
    std::error_code unknown; // for example, a name that no file can have
    return is_preset(array_presets(), name) ||
           (!fs::exists(name, unknown) && name.find_first_of("./") == std::string::npos);
}

// Reads the array file of --array.
void read_array_file(const std::string& name, environment& e)
{
    check_readable(name);
    const setup file = load_setup(name);
    if (!file.array)
        throw error(error_kind::bad_input, name, "it has no [array]", "add one, see tactor.toml(5)");
    use_array_file(e.config, file);
    e.array_file = name;
}

// Returns the array of --array NAME, else the configuration's, else the plan's, else palm-3x3.
array find_array(const settings& s, environment& e, const files::plan_file* planned)
{
    if (s.array_name && is_preset_name(*s.array_name))
        return resolve_preset(named_array(*s.array_name), e);
    if (e.config.array)
        return *e.config.array;
    if (planned == nullptr)
        return preset_array(usual_array);
    e.plan_channels = planned->render.channels;
    return planned->tactors; // includes the settings that its array file had when the plan was made
}

// Throws error if the configuration's marker or code is on the channel of a tactor of another file's array.
void check_sync_channel(const environment& e)
{
    if (!e.config.sync)
        return;
    const std::optional<code_settings>& code = e.config.sync->code;
    for (const tactor_spec& t : e.tactors.tactors) {
        const std::string why = fmt::format("channel {} drives a tactor of {}", t.channel, e.tactors.name);
        constexpr const char* spare = "choose a spare channel";
        if (t.channel == e.config.sync->channel)
            throw error(error_kind::bad_input, "[sync] channel", why, spare);
        if (code && t.channel == code->channel)
            throw error(error_kind::bad_input, code->where, "code: " + why, spare);
    }
}

// Returns the carrier frequency of a plan that is farthest from `hz`.
double find_farthest_carrier(const plan& p, double hz)
{
    const auto away = [hz](double f) { return std::abs(f - hz); };
    // For a recording along the path the course contains its repetition rate.
    if (p.course.empty() || p.wave.kind == waveform_kind::recording)
        return p.carrier_hz;
    return std::max_element(
               p.course.begin(), p.course.end(),
               [&](const carrier_point& a, const carrier_point& b) { return away(a.hz) < away(b.hz); })
        ->hz;
}

} // namespace

array resolve_preset(array preset, environment& e)
{
    setup& config = e.config;
    array configured = config.array ? *config.array : preset_array(usual_array);
    if (have_same_places(configured, preset)) {
        e.array_file = config.array ? e.config_name : "";
        return configured;
    }
    if (config.array)
        e.array_doubt = fmt::format(
            "{}: the array of {} has other places: its limits, gains and channels do not apply here",
            preset.name, e.config_name);
    e.array_file.clear();
    config.output.channels.reset();
    config.calibration.reset();
    return preset;
}

bool is_preset(const std::vector<std::string>& presets, const std::string& name)
{
    return std::find(presets.begin(), presets.end(), name) != presets.end();
}

environment read_environment(settings& s)
{
    environment e;
    e.config_name = find_config(s);
    if (!e.config_name.empty()) {
        check_readable(e.config_name);
        e.config = load_setup(e.config_name);
        e.array_file = e.config.array ? e.config_name : "";
    }
    if (s.array_name && !is_preset_name(*s.array_name))
        read_array_file(*s.array_name, e);
    options::apply_defaults(s, e.config);
    e.serve = options::read_serve(e.config.serve);
    const files::plan_file* const planned = read_plans(s, e);
    e.tactors = find_array(s, e, planned);
    if (planned != nullptr)
        use_plan_sound(*planned, s);
    options::resolve(s);
    s.actuator = e.config.texture;
    use_actuator(s.plan.wave, s.actuator);
    check_sync_channel(e);
    if (!e.array_doubt.empty())
        say(stderr, "tactor: warning: {}\n", e.array_doubt);
    return e;
}

ceiling find_ceiling(const environment& e)
{
    if (const auto& ceiling = e.serve.max_level_dbfs)
        return {*ceiling, fmt::format("max_level_dbfs, {}", e.serve.max_level_at.text())};
    settings usual;
    usual.place = options::on_play;
    options::apply_defaults(usual, e.config);
    const auto at = usual.in_file.find(options::index(*options::find("level_dbfs")));
    if (at == usual.in_file.end())
        return {usual.render.level_dbfs, "no file has max_level_dbfs under [serve]"};
    return {usual.render.level_dbfs, fmt::format("level-dbfs under [defaults], {}", at->second.text())};
}

std::string ceiling_text(const ceiling& c)
{
    return fmt::format("{} dBFS ({})", plain_number(c.dbfs, 4), c.from);
}

render_options find_render_options(const settings& s, const environment& e)
{
    render_options r = s.render;
    r.rate = s.rate.value_or(e.config.output.rate.value_or(48000));
    if (e.config.sync && e.config.sync->channel) {
        r.marker_channel = e.config.sync->channel;
        r.marker_s = e.config.sync->pulse_s;
    }
    const auto up_to = [](std::optional<unsigned> channel) { return channel ? *channel + 1 : 0; };
    const code_settings code = (e.config.sync ? e.config.sync->code : std::nullopt).value_or(code_settings{});
    const unsigned needed = std::max({e.tactors.channels(), up_to(r.marker_channel), up_to(code.channel)});
    r.channels =
        s.channels ? *s.channels : e.config.output.channels.value_or(e.plan_channels.value_or(needed));
    if (up_to(code.channel) > r.channels)
        throw error(error_kind::bad_input, code.where,
                    fmt::format("the code's channel is {}, but there {} {}", *code.channel,
                                r.channels == 1 ? "is" : "are", counted(r.channels, "channel")),
                    "count channels from 0");
    if (s.channels && *s.channels < needed)
        throw error(error_kind::bad_input, "channels",
                    fmt::format("{} needs {}", e.tactors.name, counted(needed, "channel")),
                    fmt::format("give {} or more", needed))
            .with_field("channels");
    return r;
}

std::string carrier_warning(const environment& e, std::span<const plan* const> plans)
{
    const auto alone = [](const tactor_spec& t) { return t.threshold_dbfs.has_value(); };
    if (!e.config.calibration || std::none_of(e.tactors.tactors.begin(), e.tactors.tactors.end(), alone))
        return {};
    const double measured_hz = e.config.calibration->carrier_hz;
    for (const plan* p : plans)
        if (const double hz = find_farthest_carrier(*p, measured_hz); hz != measured_hz)
            return fmt::format("the thresholds were measured at {} Hz, but a carrier is {} Hz, where "
                               "thresholds differ (tactor calibrate --carrier {} adds them)",
                               measured_hz, hz, hz);
    return {};
}

void warn_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores)
{
    if (!r.sl_db)
        return;
    std::vector<const plan*> plans;
    for (const score& s : scores)
        for (const placed_plan& p : s.plans())
            plans.push_back(&p.plan);
    if (const std::string other = carrier_warning(e, plans); !other.empty())
        say(stderr, "tactor: warning: {}\n", other);
}

} // namespace tactor::session
