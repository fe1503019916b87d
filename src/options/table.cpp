// SPDX-License-Identifier: MIT
// The rows of the table. To add an option, add a row here, and the code that uses its value.
#include <array>
#include <optional>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include <tactor/api.hpp>

#include "core/kind_names.hpp"
#include "core/refused.hpp"
#include "options/option.hpp"

namespace tactor::options {
namespace {

template <class T>
struct without_optional {
    using type = T;
};

template <class T>
struct without_optional<std::optional<T>> {
    using type = T;
};

template <class T>
void put_value(T& into, const value& v)
{
    using plain = typename without_optional<T>::type;
    if (std::holds_alternative<std::monostate>(v)) { // clears the value
        if constexpr (!std::is_same_v<plain, T>)
            into.reset();
        return;
    }
    if constexpr (std::is_same_v<plain, bool>)
        into = std::get<bool>(v);
    else if constexpr (std::is_enum_v<plain>)
        into = *detail::find_kind<plain>(std::get<std::string>(v));
    else if constexpr (std::is_same_v<plain, std::string>)
        into = std::get<std::string>(v);
    else
        into = static_cast<plain>(std::get<double>(v));
}

template <class T>
value make_value(const T& from)
{
    if constexpr (std::is_enum_v<T>)
        return std::string(to_string(from));
    else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>)
        return from;
    else
        return static_cast<double>(from);
}

template <class T>
value make_value(const std::optional<T>& from)
{
    return from ? make_value(*from) : value();
}

// Returns the functions that access one member. `Member` is a stateless function from option_values to a
// reference.
template <class Member>
constexpr access reach(Member)
{
    return {[](option_values& w, const value& v) { put_value(Member{}(w), v); },
            [](const option_values& w) { return make_value(Member{}(w)); }};
}

namespace of = detail::bounds_of;

constexpr std::uint64_t drawing = on_plan | on_render | on_plot | on_compare | on_play | on_convert;
constexpr std::uint64_t named = drawing & ~std::uint64_t{on_convert};    // an option can name the stroke
constexpr std::uint64_t rendered = drawing & ~std::uint64_t{on_compare}; // a prediction needs no sound
constexpr std::uint64_t sounding = rendered | on_check;
constexpr std::uint64_t playing = on_play | on_check | on_serve;
constexpr std::uint64_t measuring = playing | on_calibrate | on_experiment;
constexpr std::uint64_t with_device = playing | on_devices | on_calibrate | on_experiment;
constexpr std::uint64_t with_array = with_device | drawing | on_off;
constexpr std::uint64_t in_python = in_plan | in_compare;
// Places of options that affect planning. Add `live` if a stroke that receives its points one by one also
// uses the option.
constexpr std::uint64_t planned = drawing | in_defaults | by_client | in_python | planning;
// Places of options that affect the sound of bursts.
constexpr std::uint64_t heard =
    sounding | in_defaults | by_client | live | in_plan | in_score | in_method | unstated;
// Places of sound options that apply only to planned strokes.
constexpr std::uint64_t heard_together = heard & ~(live | std::uint64_t{on_check});

constexpr auto low_speed_choices = [] { return std::vector<std::string_view>{"none", "low-speed"}; };

bool has_sigma(const option_values& w)
{
    return w.compensate || w.observer == observer_kind::low_speed;
}

bool has_noise(const option_values& w)
{
    return w.plan.wave.kind == waveform_kind::noise;
}

bool has_recording(const option_values& w)
{
    return w.plan.wave.kind == waveform_kind::recording;
}

bool has_recording_along_path(const option_values& w)
{
    return has_recording(w) && w.plan.wave.texture == texture_kind::length;
}

bool has_people(const option_values& w)
{
    return w.spread.people != 0;
}

// Sets the waveform, but not seed and texture, which are separate options.
void set_waveform(option_values& w, const value& v)
{
    const waveform parsed = parse_waveform(std::get<std::string>(v));
    w.plan.wave.kind = parsed.kind;
    w.plan.wave.low_hz = parsed.low_hz;
    w.plan.wave.high_hz = parsed.high_hz;
    w.plan.wave.recorded = parsed.recorded;
}

value get_waveform(const option_values& w)
{
    return waveform_text(w.plan.wave);
}

// Reads a number in Hz, or a text "HZ:DEPTH".
void set_modulation(option_values& w, const value& v)
{
    const auto* hz = std::get_if<double>(&v);
    w.plan.am = parse_modulation(hz != nullptr ? fmt::format("{}", *hz) : std::get<std::string>(v));
}

value get_modulation(const option_values& w)
{
    return fmt::format("{}:{}", w.plan.am.hz, w.plan.am.depth);
}

// Sets the envelope, but not attack and release, which are separate options.
void set_envelope(option_values& w, const value& v)
{
    const auto& text = std::get<std::string>(v);
    const burst_envelope parsed = parse_envelope(text);
    w.render.envelope.kind = parsed.kind;
    if (text.find(':') != std::string::npos)
        w.render.envelope.tukey_part = parsed.tukey_part;
}

value get_envelope(const option_values& w)
{
    return envelope_text(w.render.envelope);
}

void set_shape(option_values& w, const value& v)
{
    const auto& name = std::get<std::string>(v);
    static_cast<void>(shape_stroke(name)); // throws if the shape is unknown
    w.shape = name;
}

void set_log(option_values& w, const value& v)
{
    const auto& name = std::get<std::string>(v);
    if (name.empty())
        throw detail::bad_field("log", "the name is empty", "name a file");
    w.stream.log = name;
}

void set_compensation(option_values& w, const value& v)
{
    w.compensate = std::get<std::string>(v) != "none";
}

value get_compensation(const option_values& w)
{
    return std::string(w.compensate ? "low-speed" : "none");
}

std::vector<std::string_view> shape_names()
{
    const auto& all = stroke_shapes();
    return {all.begin(), all.end()};
}

// clang-format off
constexpr std::array table{
    option{.name = "path", .what = kind::text, .shown = "DATA", .in = group::stroke,
           .help = "SVG path data in mm, instead of STROKE",
           .where = shown_first | named | through_server,
           .to = reach([](auto& w) -> auto& { return w.path_data; })},
    option{.name = "shape", .what = kind::text, .choices = shape_names, .in = group::stroke,
           .help = "a simple stroke as large as the array, instead of STROKE",
           .where = shown_first | named | through_server, .to = {set_shape, reach([](auto& w) -> auto& { return w.shape; }).get}},
    option{.name = "position", .what = kind::text, .shown = "NAME", .in = group::stroke,
           .help = "place on the body whose touches a .tact file plays (default: its first, front before back)",
           .where = drawing | by_client | planning,
           .to = reach([](auto& w) -> auto& { return w.position; })},
    option{.name = "duration", .field = "duration_s", .unit = "s", .allowed = of::duration_s, .in = group::stroke,
           .help = "duration of each stroke (default: the file's or preset's)",
           .where = shown_first | in_stroke | drawing | by_client | in_python | planning | in_method, .rival = "speed",
           .to = reach([](auto& w) -> auto& { return w.duration_s; })},
    option{.name = "speed", .field = "speed_mm_s", .unit = "mm/s", .allowed = of::speed_mm_s, .in = group::stroke,
           .help = "speed of each stroke, instead of its duration (default 60 if neither is set)",
           .where = shown_first | in_stroke | planned | in_method, .rival = "duration",
           .to = reach([](auto& w) -> auto& { return w.speed_mm_s; })},

    option{.name = "array", .what = kind::text, .shown = "NAME|FILE", .in = group::place,
           .help = "palm-3x3 (default), palm-2x4, dualsense, usb-7.1, or an array file",
           .where = shown_first | with_array,
           .to = reach([](auto& w) -> auto& { return w.array_name; })},
    option{.name = "config", .what = kind::text, .shown = "FILE", .in = group::place,
           .help = "configuration file, see tactor.toml(5)",
           .where = with_array,
           .to = reach([](auto& w) -> auto& { return w.config_file; })},
    option{.name = "outside", .what = kind::choice, .choices = detail::kind_names<outside_kind>, .in = group::place,
           .help = "refuse paths that leave the array, or move them to its edge (default error)",
           .where = planned | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.outside; })},
    option{.name = "fit", .what = kind::flag, .in = group::place,
           .help = "scale and centre the strokes on the array",
           .where = shown_first | in_stroke | drawing | in_python | planning,
           .to = reach([](auto& w) -> auto& { return w.fit; })},
    option{.name = "fit_margin", .field = "margin_mm", .unit = "mm", .allowed = of::margin_mm, .in = group::place,
           .help = "{fit}: distance from the array's edge (default 0)",
           .where = drawing | in_python | planning,
           .used = [](const option_values& w) { return w.fit; }, .needs = "{fit=true}",
           .to = reach([](auto& w) -> auto& { return w.fit_margin_mm; })},

    option{.name = "algorithm", .what = kind::choice, .choices = detail::kind_names<algorithm_kind>, .in = group::timing,
           .help = "method that chooses the tactors and the times (default park2016)",
           .where = shown_first | in_stroke | planned | on_check | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.algorithm; })},
    option{.name = "phantom", .what = kind::choice, .choices = detail::kind_names<phantom_kind>, .in = group::timing,
           .help = "model that shares the intensity among tactors (default inverse-distance)",
           .where = shown_first | in_stroke | planned | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.phantom; })},
    option{.name = "faces", .what = kind::choice, .choices = detail::kind_names<faces_kind>, .in = group::timing,
           .help = "inverse-distance: the three tactors around the point, or the three closest (default delaunay)",
           .where = in_stroke | planned | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.faces; })},
    option{.name = "soa", .field = "soa_s", .unit = "s", .allowed = of::soa_s,
           .range = "more than 0.0473 s and at most 0.07 s; set {burst} for a wider range", .in = group::timing,
           .help = "time from the onset of a burst to the onset of the next (default 0.07)",
           .where = in_stroke | planned | on_check | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.soa_s; })},
    option{.name = "burst", .field = "burst_s", .unit = "s", .allowed = of::burst_s, .in = group::timing,
           .help = "duration of each burst (default: from the SOA by the timing law)",
           .where = in_stroke | planned | on_check | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.burst_s; })},
    option{.name = "slope", .allowed = of::slope, .shown = "A", .in = group::timing,
           .help = "slope of the timing law SOA = A duration + S (default 0.32)",
           .where = planned | on_check | live | in_method | file_only,
           .to = reach([](auto& w) -> auto& { return w.plan.profile.slope; })},
    option{.name = "intercept", .field = "intercept_s", .unit = "s", .allowed = of::intercept_s, .in = group::timing,
           .help = "intercept of the timing law (default 0.0473)",
           .where = planned | on_check | live | in_method | file_only,
           .to = reach([](auto& w) -> auto& { return w.plan.profile.intercept_s; })},
    option{.name = "timing", .what = kind::choice, .choices = detail::kind_names<timing_kind>, .in = group::timing,
           .help = "keep the SOA, or shorten it so that the bursts end with the path (default fixed)",
           .where = planned | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.timing; })},
    option{.name = "min_duration", .field = "min_duration_s", .unit = "s", .allowed = of::min_duration_s, .in = group::timing,
           .help = "timing fit: shortest burst (default 0.02)",
           .where = planned | in_method | file_only,
           .used = [](const option_values& w) { return w.plan.timing == timing_kind::fit; }, .needs = "{timing=fit}",
           .to = reach([](auto& w) -> auto& { return w.plan.min_duration_s; })},
    option{.name = "snap", .what = kind::flag, .in = group::timing,
           .help = "tactile-brush: move a start or end onto the grid",
           .where = planned | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.snap; })},
    option{.name = "drop_points", .what = kind::flag, .in = group::timing,
           .help = "tactile-brush: drop crossings until the timing is possible",
           .where = planned | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.drop_points; })},
    option{.name = "overlap", .what = kind::choice, .choices = detail::kind_names<overlap_kind>, .in = group::timing,
           .help = "intensity of bursts that overlap on one tactor (default energy)",
           .where = planned | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.overlap; })},
    option{.name = "compensate", .what = kind::choice, .choices = low_speed_choices, .in = group::timing,
           .help = "move bursts so that the low-speed observer feels the target (default none)",
           .where = planned | in_method | unstated, .to = {set_compensation, get_compensation}},
    option{.name = "sigma_mm", .unit = "mm", .allowed = {least_sigma_mm, most_sigma_mm}, .in = group::timing,
           .help = "low-speed: uncertainty of a place on the skin (default 5)",
           .where = planned | in_method,
           .used = has_sigma, .needs = "{observer=low-speed}|{compensate=low-speed}",
           .to = reach([](auto& w) -> auto& { return w.low_speed.sigma_mm; })},
    option{.name = "sigma_v_mm_s", .unit = "mm/s", .allowed = {least_sigma_v_mm_s, most_sigma_v_mm_s}, .in = group::timing,
           .help = "low-speed: spread of the expected speeds (default 100)",
           .where = planned | in_method | file_only,
           .used = has_sigma, .needs = "{observer=low-speed}|{compensate=low-speed}",
           .to = reach([](auto& w) -> auto& { return w.low_speed.sigma_v_mm_s; })},

    option{.name = "carrier", .field = "carrier_hz", .unit = "Hz", .allowed = of::carrier_hz, .in = group::sound,
           .help = "frequency of the vibration (default 250)",
           .where = in_stroke | planned | on_check | on_calibrate | live | in_method,
           .to = reach([](auto& w) -> auto& { return w.plan.carrier_hz; })},
    option{.name = "waveform", .what = kind::text, .shown = "sine|square|triangle|sawtooth|noise:LO-HI|FILE",
           .in = group::sound,
           .help = "shape at the carrier's frequency, noise between two frequencies, or recording (default sine)",
           .where = in_stroke | sounding | in_defaults | by_client | live | in_plan | planning | in_method | unstated,
           .to = {set_waveform, get_waveform}},
    option{.name = "am", .what = kind::text, .allowed = of::am_hz, .shown = "HZ[:DEPTH]", .in = group::sound,
           .help = "amplitude modulation, depth 0 to 1 (default: none; depth 1)",
           .where = sounding | in_defaults | by_client | live | in_plan | planning | in_method | unstated,
           .to = {set_modulation, get_modulation}},
    option{.name = "noise_seed", .what = kind::whole, .allowed = of::seed, .in = group::sound,
           .help = "noise: seed of its samples (default 1)",
           .where = in_stroke | rendered | in_defaults | by_client | live | in_plan | planning | in_method,
           .used = has_noise, .needs = "{waveform=noise:LO-HI}",
           .to = reach([](auto& w) -> auto& { return w.plan.wave.seed; })},
    option{.name = "texture", .what = kind::choice, .choices = detail::kind_names<texture_kind>, .in = group::sound,
           .help = "FILE: play it as the carrier's cycle (default), at its own rate, or along the path",
           .where = in_stroke | rendered | in_defaults | live | in_plan | planning | in_method,
           .used = has_recording, .needs = "{waveform=FILE.wav}",
           .to = reach([](auto& w) -> auto& { return w.plan.wave.texture; })},
    option{.name = "texture_mm", .unit = "mm", .allowed = of::texture_mm, .in = group::sound,
           .help = "{texture=length}: length of path for the whole file (default: the whole path)",
           .where = in_stroke | rendered | in_defaults | live | in_plan | planning | in_method,
           .used = has_recording_along_path, .needs = "{waveform=FILE.wav} {texture=length}",
           .to = reach([](auto& w) -> auto& { return w.plan.wave.texture_mm; })},
    option{.name = "phase", .what = kind::choice, .choices = detail::kind_names<phase_kind>, .in = group::sound,
           .help = "start the carrier with the stroke (default), or again with each burst",
           .where = heard,
           .to = reach([](auto& w) -> auto& { return w.render.phase; })},
    option{.name = "ramp", .field = "ramp_s", .unit = "s", .allowed = of::ramp_s, .in = group::sound,
           .help = "raised-cosine ramp inside each burst (default: 0 between zero crossings, else 0.002)",
           .where = heard,
           .to = reach([](auto& w) -> auto& { return w.render.ramp_s; })},
    option{.name = "envelope", .what = kind::text, .shown = "raised-cosine|linear|exponential|tukey[:PART]",
           .in = group::sound,
           .help = "rise and fall of a burst (default raised-cosine; tukey: PART of the burst, default 0.5)",
           .where = heard, .to = {set_envelope, get_envelope}},
    option{.name = "attack", .field = "attack_s", .unit = "s", .allowed = of::ramp_s, .in = group::sound,
           .help = "time in which each burst rises (default: {ramp})",
           .where = heard,
           .to = reach([](auto& w) -> auto& { return w.render.envelope.attack_s; })},
    option{.name = "release", .field = "release_s", .unit = "s", .allowed = of::ramp_s, .in = group::sound,
           .help = "time in which each burst falls (default: that of its rise)",
           .where = heard,
           .to = reach([](auto& w) -> auto& { return w.render.envelope.release_s; })},
    option{.name = "tukey_part", .allowed = of::part, .in = group::sound,
           .help = "envelope tukey: part of the burst in which it rises and falls (default 0.5)",
           .where = live | in_plan | in_score,
           .used = [](const option_values& w) { return w.render.envelope.kind == envelope_kind::tukey; },
           .needs = "{envelope=tukey}",
           .to = reach([](auto& w) -> auto& { return w.render.envelope.tukey_part; })},

    option{.name = "level_dbfs", .unit = "dBFS", .allowed = of::level_dbfs, .shown = "DB", .in = group::level,
           .help = "peak of the carrier at intensity 1 (default -12)",
           .where = shown_first | heard, .rival = "sl",
           .to = reach([](auto& w) -> auto& { return w.render.level_dbfs; })},
    option{.name = "sl", .field = "sl_db", .unit = "dB SL", .allowed = of::sl_db, .shown = "DB", .in = group::level,
           .help = "level above each tactor's threshold, instead of dBFS",
           .where = heard | on_compare | in_compare, .rival = "level_dbfs",
           .to = reach([](auto& w) -> auto& { return w.render.sl_db; })},
    option{.name = "together", .what = kind::choice, .choices = detail::kind_names<together_kind>, .in = group::level,
           .help = "strokes that overlap on a tactor: weaken all to stay within the level, or let them add up (default weaken)",
           .where = heard_together,
           .to = reach([](auto& w) -> auto& { return w.render.together; })},
    option{.name = "intensity_scale", .what = kind::choice, .choices = detail::kind_names<scale_kind>, .in = group::level,
           .help = "scale of intensities: amplitude (default), dB of {sl}, or felt strength",
           .where = planned | live | in_method | unstated,
           .to = reach([](auto& w) -> auto& { return w.plan.scale.kind; })},
    option{.name = "stevens_exponent", .allowed = of::stevens_exponent, .shown = "E", .in = group::level,
           .help = "felt = amplitude^E (default 0.6, at 250 Hz; 0.95 at 60 Hz: Stevens 1968)",
           .where = planned | live | in_method | file_only,
           .used = [](const option_values& w) { return w.plan.scale.kind == scale_kind::stevens; },
           .needs = "{intensity_scale=stevens}",
           .to = reach([](auto& w) -> auto& { return w.plan.scale.exponent; })},
    option{.name = "intensity_max", .allowed = of::intensity_max, .shown = "MAX", .in = group::level,
           .help = "intensity in a recording that means 1 (default 1; 100: per cent, 127: MIDI, 255: 8 bits)",
           .where = drawing | in_defaults | by_client | live | planning,
           .to = reach([](auto& w) -> auto& { return w.intensity_max; })},

    option{.name = "rate", .unit = "Hz", .what = kind::whole, .allowed = of::rate_hz, .in = group::device,
           .help = "sample rate (default 48000)",
           .where = in_player | sounding | on_devices | in_defaults | in_plan | in_score,
           .to = reach([](auto& w) -> auto& { return w.rate; })},
    option{.name = "sample_format", .what = kind::choice, .choices = detail::kind_names<format_kind>, .in = group::device,
           .help = "format of the samples (render: float; play: the device's)",
           .where = in_player | sounding | on_devices | in_defaults,
           .to = reach([](auto& w) -> auto& { return w.format; })},
    option{.name = "device", .what = kind::text, .shown = "PCM", .letter = "D", .in = group::device,
           .help = "ALSA device, e.g. hw:CARD=Tactor (default: the configuration's, else null)",
           .where = shown_first | with_device,
           .to = reach([](auto& w) -> auto& { return w.pcm; })},
    option{.name = "channels", .unit = "channels", .what = kind::whole, .allowed = of::device_channels, .shown = "N",
           .in = group::device,
           .help = "channels of the stream (default: the configuration's, else what the array needs)",
           .where = in_player | with_device | on_render | on_convert | in_score,
           .to = reach([](auto& w) -> auto& { return w.channels; })},
    option{.name = "marker_channel", .what = kind::whole, .allowed = of::marker_channel, .in = group::device,
           .help = "spare channel that marks each stroke's first frames",
           .where = in_score,
           .to = reach([](auto& w) -> auto& { return w.render.marker_channel; })},
    option{.name = "marker_s", .unit = "s", .allowed = of::marker_s, .in = group::device,
           .help = "duration of the mark (default 0.005)",
           .where = in_score,
           .used = [](const option_values& w) { return w.render.marker_channel.has_value(); }, .needs = "{marker_channel=N}",
           .to = reach([](auto& w) -> auto& { return w.render.marker_s; })},
    option{.name = "no_gpio", .what = kind::flag, .in = group::device,
           .help = "do not use the lines of [amplifier] and [sync]",
           .where = in_player | measuring,
           .to = reach([](auto& w) -> auto& { return w.stream.no_gpio; })},
    option{.name = "no_desktop", .what = kind::flag, .in = group::device,
           .help = "ask neither RealtimeKit, a sound server nor logind",
           .where = in_player | measuring | in_defaults | file_only,
           .to = reach([](auto& w) -> auto& { return w.stream.no_desktop; })},
    option{.name = "power_dbfs", .unit = "dB", .allowed = of::power_dbfs, .in = group::device,
           .help = "limit on the power of all tactors together, above one channel's full scale (default 4.77)",
           .where = in_player | playing | in_score,
           .to = reach([](auto& w) -> auto& { return w.stream.power_dbfs; })},
    option{.name = "max_drive_s", .unit = "s", .allowed = of::drive_s, .in = group::device,
           .help = "longest time that one tactor vibrates without a rest (default 5)",
           .where = in_player | playing | in_score,
           .to = reach([](auto& w) -> auto& { return w.stream.max_drive_s; })},
    option{.name = "drive_window_s", .field = "window_s", .unit = "s", .allowed = of::drive_s, .in = group::device,
           .help = "period in which a tactor may vibrate for {max_drive_s} in the long run (default 10)",
           .where = in_player | playing | in_score,
           .to = reach([](auto& w) -> auto& { return w.stream.drive_window_s; })},

    option{.name = "latency_ms", .unit = "ms", .allowed = of::latency_ms, .in = group::real_time,
           .help = "length of the device's buffer (periods x period)",
           .where = in_player | measuring | in_defaults, .rival = "period_frames",
           .to = reach([](auto& w) -> auto& { return w.stream.latency_ms; })},
    option{.name = "period_frames", .unit = "frames", .what = kind::whole, .allowed = of::period_frames, .shown = "N",
           .in = group::real_time,
           .help = "frames in a period, instead of {latency_ms} (default: the configuration's, else 96)",
           .where = in_player | measuring, .rival = "latency_ms",
           .to = reach([](auto& w) -> auto& { return w.stream.period_frames; })},
    option{.name = "periods", .unit = "periods", .what = kind::whole, .allowed = of::periods, .shown = "N",
           .in = group::real_time,
           .help = "periods in the buffer (default: the configuration's, else 3)",
           .where = in_player | measuring,
           .to = reach([](auto& w) -> auto& { return w.stream.periods; })},
    option{.name = "require_realtime", .what = kind::flag, .in = group::real_time,
           .help = "fail without real-time priority and locked memory",
           .where = in_player | measuring,
           .to = reach([](auto& w) -> auto& { return w.stream.require_realtime; })},
    option{.name = "void_on_xrun", .what = kind::flag, .in = group::real_time,
           .help = "end the run when an xrun or a lost device interrupts a stroke",
           .where = on_play | through_server,
           .to = reach([](auto& w) -> auto& { return w.stream.void_on_xrun; })},
    option{.name = "reopen_s", .unit = "s", .allowed = of::reopen_s, .range = "0 s or more", .in = group::real_time,
           .help = "time to wait for a lost device before the next stroke (default 0)",
           .where = on_play,
           .to = reach([](auto& w) -> auto& { return w.stream.reopen_s; })},
    option{.name = "arm", .what = kind::flag, .in = group::real_time,
           .help = "start each stroke at an edge on the [sync] in line",
           .where = on_play | through_server,
           .to = reach([](auto& w) -> auto& { return w.stream.arm; })},
    option{.name = "sync_delay_ms", .unit = "ms", .allowed = of::sync_delay_ms, .in = group::real_time,
           .help = "time from the edge to the stroke's first sample at the DAC (default 50)",
           .where = in_player | on_play | on_serve,
           .to = reach([](auto& w) -> auto& { return w.stream.sync_delay_ms; })},
    option{.name = "live", .what = kind::flag, .in = group::real_time,
           .help = "follow lines \"x y [intensity]\" from standard input; STROKE is -",
           .where = on_play | through_server,
           .to = reach([](auto& w) -> auto& { return w.stream.live; })},
    option{.name = "smooth", .field = "smooth_s", .unit = "s", .allowed = of::smooth_s, .in = group::real_time,
           .help = "with {live}: move evenly, and reach each point this long after it came (default 0)",
           .where = on_play | live | through_server,
           .to = reach([](auto& w) -> auto& { return w.stream.smooth_s; })},

    option{.name = "observer", .what = kind::choice, .choices = detail::kind_names<observer_kind>, .in = group::output,
           .help = "model that predicts what people feel (default centroid)",
           .where = on_compare | in_defaults | in_compare,
           .to = reach([](auto& w) -> auto& { return w.observer; })},
    option{.name = "spread", .what = kind::whole, .allowed = of::people, .in = group::output,
           .help = "also predict for this many people, drawn at random",
           .where = on_compare | in_compare,
           .to = reach([](auto& w) -> auto& { return w.spread.people; })},
    option{.name = "spread_seed", .what = kind::whole, .allowed = of::spread_seed, .in = group::output,
           .help = "{spread}: seed of the draw (default 1)",
           .where = on_compare | in_compare | in_defaults | file_only, .used = has_people, .needs = "{spread=N}",
           .to = reach([](auto& w) -> auto& { return w.spread.seed; })},
    option{.name = "spread_sigma", .allowed = of::spread_sigma, .shown = "FACTOR", .in = group::output,
           .help = "{spread}: factor by which people's low-speed sigma differs (default 2)",
           .where = on_compare | in_compare, .used = has_people, .needs = "{spread=N}",
           .to = reach([](auto& w) -> auto& { return w.spread.sigma_factor; })},
    option{.name = "spread_threshold_db", .unit = "dB", .allowed = of::spread_threshold_db, .in = group::output,
           .help = "{spread}: range of thresholds, plus and minus (default 6)",
           .where = on_compare | in_compare, .used = has_people, .needs = "{spread=N}",
           .to = reach([](auto& w) -> auto& { return w.spread.threshold_db; })},
    option{.name = "spread_place_mm", .unit = "mm", .allowed = of::spread_place_mm, .in = group::output,
           .help = "{spread}: range of each tactor's place (default 2)",
           .where = on_compare | in_compare, .used = has_people, .needs = "{spread=N}",
           .to = reach([](auto& w) -> auto& { return w.spread.place_mm; })},
    option{.name = "verbose", .what = kind::flag, .in = group::output,
           .help = "report the opened stream, xruns, mutes and limits on standard error",
           .where = playing | on_calibrate | on_experiment,
           .to = reach([](auto& w) -> auto& { return w.stream.verbose; })},
    option{.name = "log", .what = kind::text, .shown = "FILE", .in = group::output,
           .help = "append what {verbose} reports to a file",
           .where = playing | on_experiment, .to = {set_log, reach([](auto& w) -> auto& { return w.stream.log; }).get}},
};
// clang-format on

static_assert(table.size() <= most_options);

} // namespace

std::span<const option> all() noexcept
{
    return table;
}

} // namespace tactor::options
