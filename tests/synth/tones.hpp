// SPDX-License-Identifier: MIT
// Spectra of carriers and waves: a tone of each, and its lines.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include "pieces.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/make_timbre.hpp"

namespace tones {

using namespace tactor;
using namespace pieces;

inline constexpr unsigned rate = 48000;
inline constexpr std::size_t frames = 65536;
inline constexpr double line_hz = static_cast<double>(rate) / frames;

inline waveform shape(waveform_kind k)
{
    waveform w;
    w.kind = k;
    return w;
}

inline waveform noise(double low_hz, double high_hz, std::uint64_t seed = 1)
{
    waveform w = shape(waveform_kind::noise);
    w.low_hz = low_hz;
    w.high_hz = high_hz;
    w.seed = seed;
    return w;
}

inline waveform recorded(std::vector<float> samples, texture_kind texture, double rate_hz = 8000.0)
{
    waveform w = shape(waveform_kind::recording);
    w.recorded = std::make_shared<const recording>(recording{"x.wav", rate_hz, std::move(samples)});
    w.texture = texture;
    return w;
}

inline plan tone(const waveform& w, double hz, double duration_s = 1.5, double amplitude = 1.0)
{
    plan p = pieces::make_plan({make_burst(0.0, duration_s, {{0, amplitude}})}, hz);
    p.wave = w;
    return p;
}

inline std::vector<double> played(const plan& p, double level_dbfs = 0.0, unsigned at_rate = rate)
{
    render_options o{.rate = at_rate, .ramp_s = 0.0, .level_dbfs = level_dbfs};
    return channel(score(row(1), p, o), 0);
}

/// Returns the amplitude of each line in the middle of a tone, in a window of Blackman and Harris (sidelobes:
/// -92 dB).
inline std::vector<double> lines(const std::vector<double>& x)
{
    REQUIRE(x.size() >= 2000 + frames);
    synth::spectrum s(frames);
    for (std::size_t n = 0; n < frames; ++n) {
        const double a = static_cast<double>(n) / frames;
        const double w = 0.35875 - 0.48829 * std::cos(2 * pi * a) + 0.14128 * std::cos(4 * pi * a) -
                         0.01168 * std::cos(6 * pi * a);
        s[n] = w * x[2000 + n] * (2.0 / (0.35875 * frames));
    }
    synth::fourier_sum(s);
    std::vector<double> amplitudes(frames / 2);
    std::transform(s.begin(), s.begin() + frames / 2, amplitudes.begin(),
                   [](const std::complex<double>& v) { return std::abs(v); });
    return amplitudes;
}

/// Returns the amplitude of a sine at a frequency: the window spreads its power over lines, as 2.0044 of
/// them.
inline double strongest(const std::vector<double>& spectrum, double hz)
{
    const auto at = static_cast<std::ptrdiff_t>(std::lround(hz / line_hz));
    double power = 0.0;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(at - 5, 0); i <= at + 5; ++i)
        power += spectrum[static_cast<std::size_t>(i)] * spectrum[static_cast<std::size_t>(i)] / 2.0044;
    return std::sqrt(power);
}

/// Returns the strongest line farther than 8 from every multiple of `hz`, in dB below the strongest of all.
inline double stray_db(const std::vector<double>& spectrum, double hz, double offset_hz = 0.0)
{
    double stray = 0.0;
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        const double turns = (static_cast<double>(i) * line_hz - offset_hz) / hz;
        if (std::abs(turns - std::round(turns)) * hz > 8.0 * line_hz)
            stray = std::max(stray, spectrum[i]);
    }
    return 20.0 * std::log10(stray / *std::max_element(spectrum.begin(), spectrum.end()));
}

inline double greatest(const std::vector<double>& x)
{
    return std::abs(
        *std::max_element(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
}

} // namespace tones
