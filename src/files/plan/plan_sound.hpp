// SPDX-License-Identifier: MIT
/// \file
/// Sound of a plan's stroke as its JSON has it: without defaults, and with files by their names.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactor/plan.hpp>

#include "core/members.hpp"
#include "files/json/json_value.hpp"
#include "files/plan/plan_file.hpp"

namespace tactor::files {

/// Contents of a WAV file, as far as they tell whether it has changed.
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

plan_sound record_sound(const plan& p);

/// Puts the sound into the plan; reads the WAV file that it names, or refuses it. `stroke` is where it
/// stands. \throws error (bad_input).
void set_sound(plan& p, const plan_sound& sound, const json_value& stroke, recordings_kind recordings);

template <class Io, detail::either<recording_facts> Facts>
void members(Io& io, Facts& f)
{
    io("file", f.file, {"its whole name"});
    io("sha256", f.sha256, {"SHA-256 of its bytes"});
    io("frames", f.frames, {"its samples"});
    io("rate", f.rate, {"their rate in hertz", detail::above_0});
}

template <class Io, detail::either<carrier_point> Point>
void members(Io& io, Point& c)
{
    io("t_s", c.t_s, {"time from the stroke's beginning", detail::from_0});
    io("hz", c.hz, {"frequency", {0.0, detail::bounds_of::carrier_hz.high}});
    io.with("bend", detail::omit_usual(c.bend, carrier_point{}.bend),
            [&c](const auto& given) { c.bend = given.value_or(c.bend); },
            {"only where easing or a change of speed bends it: [a, b, c, d], Hz. With u from 0 to 1 between "
             "the times of this point and the next, the carrier is hz + u (next - hz) + u (1 - u) (a + b u + "
             "c u^2 + d u^3); the carrier's cycles are its integral, to 1e-9 over an hour",
             {-1e7, 1e7}});
}

template <class Io, detail::either<plan_sound> Sound>
void members(Io& io, Sound& s)
{
    constexpr detail::about texture{
        "only of a WAV file: how it lies along the stroke, and how much of the path has all of it",
        detail::from_0};
    io("waveform", s.waveform, {"what vibrates, as {waveform} says it; absent: a sine"});
    io("noise_seed", s.noise_seed, {"only of noise: which"});
    io("recording", s.recording,
       {"only of a WAV file: which. A plan is refused where the file has changed. A file of that name and "
        "contents beside the plan counts, too"});
    io("texture", s.texture, texture);
    io("texture_mm", s.texture_mm, texture);
    io("am_hz", s.am_hz, {"only with amplitude modulation: its frequency and depth", detail::above_0});
    io("am_depth", s.am_depth,
       {"only with amplitude modulation: its frequency and depth", detail::bounds_of::part});
    io("course", s.course,
       {"only of a carrier that changes: its frequency over time, linear between these points where bend "
        "does not say otherwise; of a WAV file along the path, how often that comes round"});
}

} // namespace tactor::files
