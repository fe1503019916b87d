// SPDX-License-Identifier: MIT
#include "synth/tone/make_timbre.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/words.hpp"
#include "synth/tone/waves.hpp"

namespace tactor::synth {

namespace {

/// Most timbres that strokes of one score share. Strokes beyond it have their own.
constexpr std::size_t most_places = 64;

/// Most frames of a recording at the rate of the stream: 32 MB.
constexpr double most_loop_frames = 8388608.0;

/// A modulation that is no farther from a harmonic, Hz, multiplies it into a displacement that stands still
/// or follows the difference: it heats the actuator and presses on the skin, and nobody feels it as a
/// vibration.
constexpr double least_beat_hz = 5.0;

/// Least amplitude of a harmonic that counts, as a part of the peak.
constexpr double least_harmonic = 0.01;

/// Returns the integral of the frequency from a point to the next, cycles: coefficients of u, u^2, ..., u^6.
std::array<double, 6> integrate(const carrier_point& from, const carrier_point& to)
{
    const double time_s = to.t_s - from.t_s;
    const std::array<double, 4>& b = from.bend;
    return {time_s * from.hz,
            time_s * (to.hz - from.hz + b[0]) / 2.0,
            time_s * (b[1] - b[0]) / 3.0,
            time_s * (b[2] - b[1]) / 4.0,
            time_s * (b[3] - b[2]) / 5.0,
            time_s * -b[3] / 6.0};
}

std::vector<course_part> make_course(const std::vector<carrier_point>& points, unsigned rate)
{
    std::vector<course_part> parts;
    double cycles = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const carrier_point& from = points[i];
        const carrier_point& to = points[std::min(i + 1, points.size() - 1)];
        const double frames = (to.t_s - from.t_s) * rate;
        const double change = frames > 0.0 ? (to.hz - from.hz) / rate / frames : 0.0;
        if (frames > 0.0 || i + 1 == points.size())
            parts.push_back({from.t_s * rate, cycles, from.hz / rate, 0.5 * change});
        if (frames > 0.0 && from.bend != carrier_point{}.bend) {
            parts.back().frames = frames;
            parts.back().bent = integrate(from, to);
            for (const double c : parts.back().bent)
                cycles += c;
        } else {
            cycles += 0.5 * (to.t_s - from.t_s) * (from.hz + to.hz);
        }
        cycles -= std::floor(cycles);
    }
    return parts;
}

/// Returns the lowest and the highest frequency of the carrier at the points of its course.
std::pair<double, double> carrier_range(const plan& p)
{
    if (p.course.empty())
        return {p.carrier_hz, p.carrier_hz};
    const auto lower = [](const carrier_point& a, const carrier_point& b) { return a.hz < b.hz; };
    const auto [low, high] = std::minmax_element(p.course.begin(), p.course.end(), lower);
    return {low->hz, high->hz};
}

/// Refuses a modulation at a harmonic of the carrier, or which a varying carrier's harmonic passes.
void refuse_displacement(const timbre& t, const plan& p)
{
    const auto [low_hz, high_hz] = carrier_range(p);
    const std::size_t points = t.is_sine() ? 4 : t.samples->size() - cycle_margin;
    const double first = std::max(std::ceil((p.am.hz - least_beat_hz) / high_hz), 1.0);
    const double last = std::min(std::floor((p.am.hz + least_beat_hz) / low_hz), 0.5 * points - 1.0);
    if (!(first <= last))
        return;
    spectrum harmonics{0.0, 0.5};
    if (!t.is_sine())
        harmonics =
            fourier_coefficients(std::span(t.samples->data(), points), static_cast<std::size_t>(last) + 1);
    for (auto k = static_cast<std::size_t>(first); k <= static_cast<std::size_t>(last); ++k) {
        if (2.0 * std::abs(harmonics[k]) < least_harmonic)
            continue;
        const auto n = static_cast<double>(k);
        const std::string what = k == 1 ? "the carrier" : fmt::format("harmonic {} of the carrier", k);
        throw detail::bad_field(
            "am",
            p.course.empty()
                ? fmt::format(
                      "{} Hz is within {} Hz of {}, {} Hz: their product is a displacement that hardly "
                      "moves, not a vibration",
                      p.am.hz, least_beat_hz, what, n * p.carrier_hz)
                : fmt::format("{} passes {} Hz on its way from {} to {} Hz: their product is there a "
                              "displacement that hardly moves, not a vibration",
                              what, p.am.hz, n * low_hz, n * high_hz),
            "choose a rate farther from the carrier, such as 30 Hz");
    }
}

void check_length(const recording& r, unsigned rate)
{
    const double frames = static_cast<double>(r.samples.size()) * rate / r.rate_hz;
    if (frames > most_loop_frames) {
        throw error(
            error_kind::bad_input, recording_name(r),
            fmt::format("it lasts {:.6g} s, which is too long at a rate of {} Hz", frames / rate, rate),
            fmt::format("give at most {:.6g} s", most_loop_frames / rate));
    }
}

void check_free_place(const char* what, double hz, double am_hz, unsigned rate)
{
    if (!(hz + am_hz < 0.5 * rate)) {
        throw detail::bad_field(what,
                                fmt::format("{}{} Hz cannot be rendered at a rate of {} Hz",
                                            am_hz > 0.0 ? "with its modulation " : "", hz + am_hz, rate),
                                fmt::format("stay below {} Hz, half the rate", 0.5 * rate));
    }
}

/// Returns the number of a wave's harmonics below half the rate, sidebands included.
std::size_t harmonics_below(double hz, double am_hz, unsigned rate)
{
    const double partials = (0.5 * rate - am_hz) / hz;
    return static_cast<std::size_t>(
        std::clamp(std::ceil(partials) - 1.0, 1.0, static_cast<double>(most_cycle_samples)));
}

void fill_in(timbre& t, const plan& p, unsigned rate)
{
    const waveform& w = p.wave;
    const double am_hz = p.am.depth > 0.0 ? p.am.hz : 0.0;
    const bool timed = w.kind == waveform_kind::recording && w.texture == texture_kind::time;
    if (w.kind == waveform_kind::noise) {
        check_free_place("waveform", w.high_hz, am_hz, rate);
        t.form = timbre::form_kind::loop;
        t.samples = std::make_shared<const wave_samples>(noise_loop(w.low_hz, w.high_hz, w.seed, rate));
    } else if (timed) {
        check_length(*w.recorded, rate);
        t.form = timbre::form_kind::loop;
        t.samples = std::make_shared<const wave_samples>(recorded_loop(*w.recorded, rate));
    } else {
        const double high_hz = carrier_range(p).second;
        check_free_place(carrier_field(p), high_hz, am_hz, rate);
        if (w.kind == waveform_kind::sine)
            return;
        const std::size_t harmonics = harmonics_below(high_hz, am_hz, rate);
        t.form = timbre::form_kind::cycle;
        t.samples = std::make_shared<const wave_samples>(
            w.kind == waveform_kind::recording ? recorded_cycle(*w.recorded, harmonics)
                                               : shape_cycle(w.kind, std::min(harmonics, most_harmonics)));
    }
    t.power = wave_power(*t.samples);
}

bool sound_alike(const plan& a, const plan& b)
{
    return a.carrier_hz == b.carrier_hz && a.am == b.am && a.course == b.course && a.wave == b.wave;
}

} // namespace

std::shared_ptr<const timbre> make_timbre(const plan& p, unsigned rate)
{
    validate(p.wave);
    validate(p.am);
    const bool modulated = p.am.hz > 0.0 && p.am.depth > 0.0;
    if (p.wave.kind == waveform_kind::sine && !modulated && p.course.empty())
        return nullptr;
    auto t = std::make_shared<timbre>();
    t->cycles_per_frame = p.carrier_hz / rate;
    t->course = make_course(p.course, rate);
    if (modulated) {
        t->am_cycles_per_frame = p.am.hz / rate;
        t->am_depth = p.am.depth;
    }
    fill_in(*t, p, rate);
    const bool has_carrier =
        t->form != timbre::form_kind::loop &&
        !(p.wave.kind == waveform_kind::recording && p.wave.texture == texture_kind::length);
    if (modulated && has_carrier)
        refuse_displacement(*t, p);
    return t;
}

const char* carrier_field(const plan& p) noexcept
{
    return p.course.empty() || p.wave.kind == waveform_kind::recording ? "carrier_hz" : "carrier_profile";
}

bool crosses_zero(const plan& p) noexcept
{
    return p.course.empty() && p.wave.kind != waveform_kind::noise && p.wave.kind != waveform_kind::recording;
}

std::shared_ptr<const timbre> timbre_shelf::get(const plan& p, unsigned rate)
{
    for (const place& q : places_)
        if (sound_alike(q.sound, p))
            return q.made;
    std::shared_ptr<const timbre> made = make_timbre(p, rate);
    if (made && places_.size() < most_places) {
        plan sound;
        sound.carrier_hz = p.carrier_hz;
        sound.wave = p.wave;
        sound.am = p.am;
        sound.course = p.course;
        places_.push_back({std::move(sound), made});
    }
    return made;
}

} // namespace tactor::synth
