// SPDX-License-Identifier: MIT
/// \file
/// Descriptions of the members of tactor-plan/1, in their order. Writer, reader, schema and the manual's page
/// use them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/tactor.hpp>

#include "core/members.hpp"
#include "files/json/json_value.hpp"
#include "files/plan/plan_json.hpp"

namespace tactor::files {

using detail::describe_unless_usual;
using detail::either;

/// Facts about a WAV file, from which a change of the file can be detected.
struct recording_facts {
    std::string file = {};
    std::string sha256 = {};
    std::uint64_t frames = 0;
    double rate = 0.0;
};

struct plan_sound {
    std::optional<std::string> waveform = {};
    std::optional<std::uint64_t> noise_seed = {};
    std::optional<recording_facts> recording = {};
    std::optional<texture_kind> texture = {};
    std::optional<double> texture_mm = {};
    std::optional<double> am_hz = {};
    std::optional<double> am_depth = {};
    std::optional<std::vector<carrier_point>> course = {};
};

plan_sound make_plan_sound(const plan& p);

template <class Io, either<recording_facts> Facts>
void members(Io& io, Facts& f)
{
    io("file", f.file, {"its whole name"});
    io("sha256", f.sha256, {"SHA-256 of its bytes"});
    io("frames", f.frames, {"its samples"});
    io("rate", f.rate, {"their rate in hertz", detail::above_0});
}

template <class Io, either<carrier_point> Point>
void members(Io& io, Point& c)
{
    io("t_s", c.t_s, {"time from the stroke's start", detail::from_0});
    io("hz", c.hz, {"frequency", {0.0, detail::bounds_of::carrier_hz.high}});
    describe_unless_usual(
        io, "bend", c.bend, carrier_point{}.bend,
        {"only if easing or a change of speed bends it: [a, b, c, d], Hz. With u from 0 to 1 "
         "between the times of this point and the next, the carrier is hz + u (next - hz) + u (1 - "
         "u) (a + b u + c u^2 + d u^3); the carrier's cycles are its integral, to 1e-9 over an hour",
         {-1e7, 1e7}});
}

template <class Io, either<plan_sound> Sound>
void members(Io& io, Sound& s)
{
    constexpr detail::about texture{"only for a WAV file: how it extends along the stroke, and the length of "
                                    "path that the whole file covers",
                                    detail::from_0};
    io("waveform", s.waveform, {"the waveform, as for {waveform}; absent: a sine"});
    io("noise_seed", s.noise_seed, {"only for noise: its seed"});
    io("recording", s.recording,
       {"only for a WAV file: which file. If the file has changed, tactor refuses the plan. A file with the "
        "same name and contents in the folder of the plan is also accepted"});
    io("texture", s.texture, texture);
    io("texture_mm", s.texture_mm, texture);
    io("am_hz", s.am_hz, {"only with amplitude modulation: its frequency and depth", detail::above_0});
    io("am_depth", s.am_depth,
       {"only with amplitude modulation: its frequency and depth", detail::bounds_of::part});
    io("course", s.course,
       {"only for a carrier that changes: its frequency over time, linear between these points unless bend "
        "says otherwise; for a WAV file along the path, how often the file repeats"});
}

/// A single threshold, or a list of pairs of a frequency, Hz, and its threshold.
using thresholds = detail::nullable<std::variant<double, std::vector<std::array<double, 2>>>>;

thresholds find_thresholds(const tactor_spec& t);
void set_thresholds(tactor_spec& t, const thresholds& v);

/// A fit as the map x' = a x + c y + e, y' = b x + d y + f. The order of its numbers is that of SVG.
struct fit_matrix {
    double margin_mm = 0.0;
    std::array<double, 6> matrix = {};
};

std::optional<fit_matrix> make_matrix(const std::optional<fitting>& f);
fitting make_fitting(const fit_matrix& content);

/// Signal on a channel that marks the start of each stroke.
struct marker {
    unsigned channel = 0;
    double duration_s = 0.0;
};

/// The place and time at which a score would be loudest.
struct loudest_place {
    unsigned tactor = 0;
    double at_s = 0.0;
    std::vector<std::size_t> strokes = {};
};

template <class Io, either<loudest_place> Place>
void members(Io& io, Place& p)
{
    io("tactor", p.tactor, {"number of the tactor"});
    io("at_s", p.at_s, {"when, from the start of the piece", detail::from_0});
    io("strokes", p.strokes,
       {"the strokes that sound there at that time: their places in the piece, from 0"});
}

/// Describes by how much a piece is weaker than requested, and the place where its strokes overlap.
template <class Io>
void describe_weakening_members(Io& io, const weakening& w)
{
    io.describe_derived(
        "weakened_db", [&w] { return std::optional(w.weakened_db); },
        {"how much weaker than requested the whole piece is, so that no tactor exceeds the level, see "
         "{together}; 0: not at all",
         detail::up_to_0});
    io.describe_derived("meets",
                        [&w] {
                            return w.weakened_db < 0.0
                                       ? std::optional(loudest_place{w.tactor, w.at_s, w.plans})
                                       : std::nullopt;
                        },
                        {"only if it is weakened: the place and time of the highest level"});
}

/// Members of a plan that is being read. The struct written_plan has the same members for writing.
struct plan_parts {
    std::string name = {};
    note_kind note = note_kind::none;
    double start_s = 0.0;
    bool follows = true;
    tactor::plan plan = {};
    plan_sound sound = {};
    std::optional<fitting> fit = {};
    array tactors = {};
    render_options options = {};
    std::optional<compensated_plan> moved = {};
    bool is_sampled = false;
    double step_s = continuous_step_s;
    std::uint64_t start_frame = 0;
    std::uint64_t frames = 0;
    weakening weakened = {};
};

/// Returns, for each tactor, the peak of its channel at amplitude 1 in a piece with this weakening. A tactor
/// that is not driven has no value.
std::vector<std::optional<double>> list_peaks_dbfs(const array& a, double carrier_hz, const render_options& o,
                                                   double weakened_db);

/// Describes the members that identify a tactor.
template <class Io, either<tactor_spec> Tactor>
void describe_identity_members(Io& io, Tactor& t, std::size_t number)
{
    io.describe_derived("tactor", [number] { return number; }, {"its number"});
    io("x_mm", t.position.x_mm, {"its place"});
    io("y_mm", t.position.y_mm, {"its place"});
    io("channel", t.channel, {"the channel that drives it"});
}

template <class Io, either<tactor_spec> Tactor>
void describe_tactor_members(Io& io, Tactor& t, std::size_t number)
{
    describe_identity_members(io, t, number);
    io("polarity", t.polarity, {"1, or -1 if its samples are inverted", {-1.0, 1.0}});
    io("gain_db", t.gain_db, {"its gain"});
    io("max_dbfs", t.max_dbfs, {"its highest allowed peak", detail::up_to_0});
    io.describe_converted(
        "threshold_dbfs", find_thresholds(t), [&t](const auto& v) { set_thresholds(t, v); },
        {"its measured threshold; a list of [frequency, threshold] if there are several; or null"});
    io("rise_s", t.rise_s,
       {"rise time of the actuator; absent if the array has none. With a rise time, a burst that sounds "
        "alone on the tactor has a boost, see Slow actuators",
        {0.0, 1.0, true}});
    io("displacement_um_at_0dbfs", t.displacement_um_at_0dbfs,
       {"measured peak displacement at 0 dBFS, um; absent if the array has none", {0.0, 10000.0, true}});
}

template <class Io, either<array> Array>
void members(Io& io, Array& a)
{
    io("name", a.name, {"name of the array"});
    io.list("tactors", a.tactors, {"all of them, in order"},
            [](auto& inner, auto& t, std::size_t number) { describe_tactor_members(inner, t, number); });
}

template <class Io, either<fit_matrix> Fit>
void members(Io& io, Fit& f)
{
    io("margin_mm", f.margin_mm, {"requested distance from the array's edge", detail::from_0});
    io("matrix", f.matrix,
       {"a, b, c, d, e, f of x' = a x + c y + e and y' = b x + d y + f, in mm; all other places in this "
        "object are x' and y'"});
}

template <class Io, either<burst_envelope> Envelope>
void members(Io& io, Envelope& e)
{
    io("kind", e.kind, {"raised-cosine, linear, exponential or tukey"});
    io("tukey_part", e.tukey_part,
       {"for tukey: both ramps together, as a part of the burst", detail::bounds_of::part});
    io.describe_or_null("attack_s", e.attack_s,
                        {"time in which they rise, or null: as {ramp} says", detail::from_0});
    io.describe_or_null("release_s", e.release_s,
                        {"time in which they fall, or null: as they rise", detail::from_0});
}

template <class Io, either<marker> Marker>
void members(Io& io, Marker& m)
{
    io("channel", m.channel, {"its channel"});
    io("duration_s", m.duration_s, {"its length", detail::above_0});
}

template <class Io, either<tap> Tap>
void members(Io& io, Tap& t)
{
    constexpr detail::about target{"where the target is then"};
    constexpr detail::about alone{"where the burst would be felt by itself"};
    constexpr detail::about felt{"where it is predicted to be felt"};
    io("onset_s", t.onset_s, {"onset of the burst", detail::from_0});
    io("target_x_mm", t.target.x_mm, target);
    io("target_y_mm", t.target.y_mm, target);
    io("alone_x_mm", t.alone.x_mm, alone);
    io("alone_y_mm", t.alone.y_mm, alone);
    io("felt_x_mm", t.felt.x_mm, felt);
    io("felt_y_mm", t.felt.y_mm, felt);
}

template <class Io, either<compensated_plan> Compensated>
void members(Io& io, Compensated& c)
{
    constexpr detail::about parameters{"its parameters", detail::above_0};
    constexpr detail::about residual{
        "the error that remains, if each burst were felt at its own point when alone", detail::from_0};
    constexpr detail::about predicted{"distance from the felt places to the target, including the phantom's "
                                      "own error; null without a felt burst",
                                      detail::from_0};
    const auto felt = [&c](auto what) {
        return [&c, what] { return detail::nullable<double>{summarise(c.taps).*what}; };
    };
    io.constant("observer", "low-speed");
    io("sigma_mm", c.observer.sigma_mm, parameters);
    io("sigma_v_mm_s", c.observer.sigma_v_mm_s, parameters);
    io.constant("built_for", "taps");
    io("bursts_at_edge", c.at_edge,
       {"number of bursts that reach the edge of the array before their intended place"});
    io("residual_rms_mm", c.residual_rms_mm, residual);
    io("residual_largest_mm", c.residual_largest_mm, residual);
    io.describe_derived("predicted_rms_mm", felt(&tap_summary::rms_error_mm), predicted);
    io.describe_derived("predicted_largest_mm", felt(&tap_summary::largest_error_mm), predicted);
    io("taps", c.taps, {"as results[].taps of tactor-compare/1"});
}

template <class Io, either<conflict> Conflict>
void members(Io& io, Conflict& c)
{
    io("tactor", c.tactor, {"number of the tactor"});
    io("from_s", c.from_s, {"start and end", detail::from_0});
    io("to_s", c.to_s, {"start and end", detail::from_0});
}

template <class Io, either<meeting> Meeting>
void members(Io& io, Meeting& m)
{
    io("tau_s", m.t_s, {"time at which the target is there", detail::from_0});
    io("x_mm", m.position.x_mm, {"where"});
    io("y_mm", m.position.y_mm, {"where"});
}

/// Describes the members that bursts and points have in common.
template <class Io, either<burst> Burst>
void describe_place_members(Io& io, Burst& b, const array& a, const char* place, const char* intensity,
                            const char* drives)
{
    io("x_mm", b.position.x_mm, {place});
    io("y_mm", b.position.y_mm, {place});
    io("intensity", b.intensity, {intensity, detail::bounds_of::part});
    io.list("drives", b.drives, {drives}, [&a](auto& inner, auto& d, std::size_t) {
        inner("tactor", d.tactor, {"number of the tactor"});
        inner.describe_derived("channel", [&] { return a.tactors[d.tactor].channel; }, {"its channel"});
        inner("amplitude", d.amplitude, {"its amplitude; 1 is the requested intensity", {0.0, 1000.0}});
    });
}

template <class Io, either<burst> Burst, class Parts>
void describe_burst_members(Io& io, Burst& b, const Parts& r)
{
    io("onset_s", b.onset_s, {"its onset", detail::from_0});
    io("duration_s", b.duration_s, {"its duration", detail::from_0});
    io.describe_derived("ramp_s", [&] { return burst_ramp_s(b.onset_s, b.duration_s, r.plan, r.options); },
                        {"raised cosine at each end of it", detail::from_0});
    io("tau_s", b.tau_s,
       {"only for tactile-brush: time at which the target is at its place", detail::from_0});
    describe_place_members(
        io, b, r.tactors, "the place where it should be felt; if bursts were moved, the place where it plays",
        "the requested intensity as an amplitude, by the intensity scale and the level of the stroke",
        "the tactors that make it, in order");
}

template <class Io, either<burst> Burst, class Parts>
void describe_point_members(Io& io, Burst& b, const Parts& r)
{
    io("t_s", b.onset_s, {"time of the point", detail::from_0});
    describe_place_members(io, b, r.tactors, "where the target is",
                           "the requested intensity as an amplitude, by the same",
                           "the tactors that sound, in order");
}

template <class Io, class Parts>
void describe_stroke_members(Io& io, Parts& r)
{
    auto& p = r.plan;
    io("name", r.name, {"its name, or that of the file"});
    io("duration_s", p.stroke_duration_s, {"time in which the target moves", detail::above_0});
    io("length_mm", p.stroke_length_mm, {"length of its path", detail::from_0});
    io("carrier_hz", p.carrier_hz,
       {"frequency of the vibration; if it changes, at the start", detail::above_0});
    members(io, r.sound);
    io.describe_converted("note", detail::omit_empty(note_text(r.note)),
                          [&r](const auto& content) {
                              r.note = content == note_text(note_kind::reconstructed)
                                           ? note_kind::reconstructed
                                           : r.note;
                          },
                          {"only for park2016-1 to -4: a note that they are reconstructed"});
    io.describe_converted("fit", make_matrix(r.fit),
                          [&r](const auto& content) {
                              if (content)
                                  r.fit = make_fitting(*content);
                          },
                          {"only with {fit}: how the places were fitted"});
}

template <class Io, class Parts>
void describe_render_members(Io& io, Parts& r)
{
    auto& o = r.options;
    io("rate", o.rate, {"sample rate in hertz", detail::bounds_of::rate_hz});
    io("channels", o.channels, {"number of channels"});
    io("frames", r.frames, {"length of the whole piece"});
    io("phase", o.phase, {"stroke or burst: where the carrier's phase starts"});
    io.describe_or_null("ramp_s", o.ramp_s,
                        {"value of {ramp}; null: the default for each burst", detail::from_0});
    io("sl_db", o.sl_db, {"value of {sl}, in dB above each tactor's threshold; only without level_dbfs"});
    io.describe_converted("level_dbfs", o.sl_db ? std::optional<double>() : std::optional(o.level_dbfs),
                          [&o](const auto& content) {
                              if (content)
                                  o.level_dbfs = *content;
                          },
                          {"value of {level_dbfs}; only without sl_db", detail::up_to_0});
    io.require_exactly_one("level_dbfs", "sl_db");
    io("overlap", r.plan.overlap, {"energy, max or sum: how bursts that overlap on one tactor combine"});
    io.describe_derived(
        "peak_dbfs",
        [&r] { return list_peaks_dbfs(r.tactors, r.plan.carrier_hz, r.options, r.weakened.weakened_db); },
        {"for each tactor in order: the peak of its channel for amplitude 1, including its gain or "
         "threshold and weakened_db; null if the level is relative to a threshold that it does not have, "
         "and nothing drives it"});
    describe_unless_usual(
        io, "together", o.together, together_kind::weaken,
        {"sum if strokes that overlap on a tactor add up; absent: the piece is weakened, as with "
         "{together=weaken}"});
    describe_unless_usual(io, "envelope", o.envelope, burst_envelope{},
                          {"how bursts rise and fall; absent: by raised cosines of ramp_s"});
    io.describe_converted("marker",
                          detail::nullable<marker>{o.marker_channel
                                                       ? std::optional(marker{*o.marker_channel, o.marker_s})
                                                       : std::nullopt},
                          [&o](const auto& content) {
                              if (!content.value)
                                  return;
                              o.marker_channel = content.value->channel;
                              o.marker_s = content.value->duration_s;
                          },
                          {"null, or the marker at each stroke's start"});
}

template <class Io, class Parts>
void describe_plan_members(Io& io, Parts& r)
{
    auto& p = r.plan;
    io.constant("schema", "tactor-plan/1");
    io.template describe_enum<algorithm_kind>("algorithm", p.algorithm,
                                              {"park2016, tactile-brush or continuous"});
    io.template describe_enum<phantom_kind>(
        "phantom", p.phantom, {"the phantom model: inverse-distance, barycentric, linear, log or gaussian"});
    describe_unless_usual(
        io, "faces", p.faces, faces_kind::delaunay,
        {"nearest if the three closest tactors of the array make a phantom; absent: those of the "
         "Delaunay face, as with {faces=delaunay}"});
    io("start_s", r.start_s,
       {"start of the stroke in the piece, which is all strokes of the file; all other times are relative to "
        "it",
        detail::from_0});
    io("start_frame", r.start_frame, {"the stroke's first frame in the piece"});
    io("follows", r.follows,
       {"true if it begins when the previous stroke ends, or the piece begins; false if its start was set"});
    io.object("stroke", {"the stroke"}, [&r](auto& inner) { describe_stroke_members(inner, r); });
    io("array", r.tactors, {"the array"});
    io.describe_or_null("soa_s", p.soa_s,
                        {"time from onset to onset; null if it differs between bursts", detail::above_0});
    io("total_s", p.total_s, {"end of the last sound", detail::from_0});
    io.object("render", {"how the plan becomes samples; the same in all strokes of a file"},
              [&r](auto& inner) { describe_render_members(inner, r); });
    describe_weakening_members(io, r.weakened);
    io.begin_new_line();
    io.template rows<burst>(
        "bursts", [&p](const auto& row) { std::for_each(p.bursts.begin(), p.bursts.end(), row); },
        {"by onset; empty for the algorithm continuous"},
        [&r](auto& inner, auto& b) { describe_burst_members(inner, b, r); });
    io.begin_new_line();
    io.describe_if_present(
        "continuous", r.is_sampled, {"only for the algorithm continuous"}, [&r](auto& inner) {
            inner("step_s", r.step_s,
                  {"time from point to point; the last is at the end of the stroke", detail::above_0});
            inner.describe_derived(
                "ramp_s", [&r] { return burst_ramp_s(0.0, r.plan.stroke_duration_s, r.plan, r.options); },
                {"raised cosine at each end of the stroke", detail::from_0});
            inner.template rows<burst>(
                "points", [&r](const auto& row) { for_each_row(r.plan, row); },
                {"from the stroke's start to its end"},
                [&r](auto& innermost, auto& b) { describe_point_members(innermost, b, r); });
        });
    io.begin_new_line();
    io("compensation", r.moved,
       {"only with {compensate}: the observer for which tactor moved the bursts; the places of the bursts "
        "are those that play"});
    io("conflicts", p.conflicts, {"times in which one tactor serves two bursts"});
    io("dropped", p.dropped, {"crossings of the grid that {drop_points} left out"});
    io("warnings", p.warnings, {"texts"});
}

} // namespace tactor::files
