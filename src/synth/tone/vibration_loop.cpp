// SPDX-License-Identifier: MIT
#include "synth/tone/vibration_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/vibration.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {
namespace {

/// Returns a wave with all its harmonics, for the few cycles of an emphasis. Each wave begins at an upward
/// zero crossing.
double plain_wave(waveform_kind shape, double turns)
{
    const double cycle = turns - std::floor(turns);
    switch (shape) {
    case waveform_kind::square:
        return cycle < 0.5 ? 1.0 : -1.0;
    case waveform_kind::triangle:
        return 1.0 - std::abs(2.0 - std::abs(3.0 - 4.0 * cycle));
    case waveform_kind::sawtooth:
        return 2.0 * (cycle < 0.5 ? cycle : cycle - 1.0);
    case waveform_kind::sine:
    case waveform_kind::noise:
    case waveform_kind::recording:
        break;
    }
    return sincos_turns(turns).sin;
}

/// Emphases that sound at a frame. An emphasis ends where the next begins, but the transients of an AHAP file
/// may overlap.
class sounding_emphases {
public:
    sounding_emphases(const vibration& v, unsigned rate) : v_(v), rate_(rate) {}

    /// Begins the emphases after `last` up to `now`, at frame n.
    void begin(std::optional<std::size_t> last, std::optional<std::size_t> now, std::size_t n)
    {
        if (!v_.own_actuator)
            all_.clear();
        if (!now)
            return;
        const std::size_t most = v_.own_actuator ? most_at_once : 1;
        const std::size_t next = last ? *last + 1 : 0;
        for (std::size_t i = std::max(next, *now + 1 - std::min(*now + 1, most)); i <= *now; ++i)
            all_.push_back({i, n});
        if (all_.size() > most_at_once)
            all_.erase(all_.begin(), all_.end() - std::ptrdiff_t{most_at_once});
    }

    /// Returns the sample of the vibration with all emphases of frame n.
    double add(double x, std::size_t n)
    {
        std::erase_if(all_,
                      [&](const sounding& s) { return age_s(s, n) >= detail::emphasis_s(v_, s.index); });
        const actuator_numbers& a = v_.actuator;
        double sum = all_.empty() ? x : a.ducking * x;
        for (const sounding& s : all_) {
            const emphasis& e = v_.emphases[s.index];
            const double own = age_s(s, n) * detail::emphasis_hz(a, e.frequency);
            const double fade = 1.0 - a.fade_out * age_s(s, n) / detail::emphasis_s(v_, s.index);
            sum += a.emphasis_gain * e.amplitude * fade *
                   std::lerp(plain_wave(a.emphasis_low_wave, own), plain_wave(a.emphasis_high_wave, own),
                             e.frequency);
        }
        return sum;
    }

private:
    struct sounding {
        std::size_t index;
        std::size_t since; // first frame
    };

    static constexpr std::size_t most_at_once = 32; // bounds the time for a frame

    double age_s(const sounding& s, std::size_t n) const noexcept
    {
        return static_cast<double>(n - s.since) / rate_;
    }

    const vibration& v_;
    unsigned rate_;
    std::vector<sounding> all_ = {};
};

} // namespace

wave_samples vibration_loop(const vibration& v, const std::vector<carrier_point>& course, std::size_t frames,
                            unsigned rate)
{
    wave_samples loop(frames);
    double turns = 0.0;  // turns of the carrier
    double rounds = 0.0; // vibrations played before the current stretch of the course
    std::size_t stretch = 0;
    double before = 0.0;
    std::optional<std::size_t> last;
    sounding_emphases sounding(v, rate);
    float peak = 1.0F;
    for (std::size_t n = 0; n < frames; ++n) {
        const double t_s = static_cast<double>(n) / rate;
        double at_s = t_s;
        if (!course.empty()) {
            while (stretch + 1 < course.size() && course[stretch + 1].t_s <= t_s) {
                rounds += course[stretch].hz * (course[stretch + 1].t_s - course[stretch].t_s);
                ++stretch;
            }
            const double part = rounds + course[stretch].hz * (t_s - course[stretch].t_s);
            // At the end of the path the vibration is at its end, not at its start again.
            at_s = v.duration_s * (part <= 1.0 + 1e-9 ? std::min(part, 1.0) : part - std::floor(part));
        }
        const std::optional<std::size_t> now = detail::last_emphasis(v, at_s);
        if (at_s < before)
            last.reset();
        if (now != last || at_s < before)
            sounding.begin(last, now, n);
        last = now;
        before = at_s;
        const double hz =
            detail::carrier_hz(v.actuator, detail::value_at(v.frequency, at_s, detail::usual_frequency));
        const double x = sounding.add(
            v.actuator.gain * detail::value_at(v.amplitude, at_s, 1.0) * sincos_turns(turns).sin, n);
        loop[n] = static_cast<float>(x);
        peak = std::max(peak, std::abs(loop[n]));
        turns += hz / rate;
        turns -= std::floor(turns);
    }
    for (float& x : loop)
        x /= peak; // an emphasis and the vibration together may exceed 1
    return loop;
}

} // namespace tactor::synth
