// SPDX-License-Identifier: MIT
// Vibrations of files as recordings, and as strokes that rest.
#include "files/vibration_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/sha256.hpp"
#include "core/vibration.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

// Returns a stroke that rests in the middle of the array.
stroke make_resting_stroke(std::vector<timed_point> points, double start_s)
{
    return {.motion = trajectory::timed(std::move(points)),
            .start_s = start_s,
            .fit = stroke_fit{},
            .choices = {.algorithm = algorithm_kind::continuous}};
}

// Returns the envelope with the ducking of each emphasis.
std::vector<timed_point> make_envelope(const vibration& v)
{
    std::vector<double> times{0.0, v.duration_s};
    const auto add = [&](double t_s) {
        for (const double t : {t_s - step_s, t_s})
            if (t > 0.0 && t < v.duration_s)
                times.push_back(t);
    };
    for (const timed_value& p : v.amplitude)
        add(p.t_s);
    for (std::size_t i = 0; i < v.emphases.size(); ++i) {
        add(v.emphases[i].t_s);
        add(emphasis_end_s(v, i));
    }
    std::sort(times.begin(), times.end());
    std::vector<timed_point> points;
    for (const double t : times) {
        const auto i = find_emphasis(v, t);
        const double intensity =
            v.actuator.gain * value_at(v.amplitude, t, 1.0) * (i ? v.actuator.ducking : 1.0);
        if (points.empty() || t - points.back().t_s >= 0.5 * step_s)
            points.push_back({t, {}, intensity});
        else
            points.back().intensity = intensity; // of the later step
    }
    points.back().t_s = v.duration_s;
    return points;
}

} // namespace

bool is_vibration_file(const std::filesystem::path& file)
{
    const std::string extension = to_lower_case(file.extension().string());
    return extension == ".haptic" || extension == ".ahap";
}

recording load_vibration(const std::filesystem::path& file)
{
    const whole_text text = read_text_file(file, max_foreign_bytes);
    const bool haptic = to_lower_case(file.extension().string()) == ".haptic";
    const std::string name = file.string();
    return {.file = name,
            .sha256 = sha256_text(text),
            .source = haptic ? read_haptic(text, name) : read_ahap(text, name)};
}

std::vector<stroke> make_vibration_strokes(const vibration& v, const std::string& name)
{
    stroke envelope = make_resting_stroke(make_envelope(v), 0.0);
    for (const timed_value& p : v.frequency)
        envelope.sound.carrier_times.push_back({p.t_s, carrier_hz(v.actuator, p.value)});
    if (v.frequency.empty())
        envelope.sound.carrier_hz = carrier_hz(v.actuator, usual_frequency);
    std::vector<stroke> all;
    const bool sounds = std::any_of(v.amplitude.begin(), v.amplitude.end(),
                                    [](const timed_value& p) { return p.value > 0.0; });
    const bool longer =
        v.emphases.empty() || v.duration_s > emphasis_end_s(v, v.emphases.size() - 1) + step_s;
    if (sounds || longer)
        all.push_back(std::move(envelope));
    for (std::size_t i = 0; i < v.emphases.size(); ++i) {
        const emphasis& e = v.emphases[i];
        const double lasts_s = emphasis_end_s(v, i) - e.t_s;
        const double shares[] = {1.0 - e.frequency, e.frequency};
        const waveform_kind kinds[] = {v.actuator.emphasis_low_wave, v.actuator.emphasis_high_wave};
        for (std::size_t k = 0; k < 2; ++k) {
            const double strength = v.actuator.emphasis_gain * e.amplitude *
                                    (kinds[0] != kinds[1] ? shares[k]
                                     : k == 0             ? 1.0
                                                          : 0.0);
            if (!(strength > 0.0 && lasts_s > step_s))
                continue;
            const double end =
                strength * std::max(0.0, 1.0 - v.actuator.fade_out * lasts_s / emphasis_s(v, i));
            all.push_back(make_resting_stroke({{0.0, {}, strength}, {lasts_s, {}, end}}, e.t_s));
            all.back().sound.carrier_hz = emphasis_hz(v.actuator, e.frequency);
            all.back().sound.wave = waveform{.kind = kinds[k]};
        }
    }
    if (all.empty())
        all.push_back(std::move(envelope));
    const std::string called = stem(name);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].name = all.size() == 1 ? called : fmt::format("{}-{}", called, i + 1);
    all.front().warnings = v.notes;
    return all;
}

} // namespace tactor::detail
