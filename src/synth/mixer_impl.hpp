// SPDX-License-Identifier: MIT
/// \file
/// The mixer's inside: what is kept from block to block, and the work on one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "synth/carrier.hpp"
#include "synth/converter.hpp"
#include "synth/fades.hpp"
#include "synth/limiter.hpp"
#include "synth/mixer.hpp"
#include "synth/voice.hpp"

namespace tactor::synth {

/// One channel in the current block.
struct strip {
    alignas(64) block sum;
    const double* lone = nullptr; ///< only one voice so far, with `gain`: its carrier in place of the sum
    double gain = 1.0;
    double limit = 0.0;
    double peak = 0.0;     ///< what the voices could reach together
    double together = 0.0; ///< what those could that last until `until`, a frame of the block
    unsigned until = 0;
    bool spare = false; ///< no tactor: for markers
    bool sounding = false;

    /// A voice of that amplitude from one frame of the block to another. They come in order of their start.
    void reach(unsigned from, unsigned to, double amplitude) noexcept
    {
        together = from < until ? together + amplitude : amplitude;
        until = std::max(until, to);
        peak = std::max(peak, together);
    }
};

struct mixer::impl {
    impl(std::span<const double> limits, sample_format f, std::size_t capacity, const guard_settings& g)
        : format(f),
          strips(limits.size()),
          voices(capacity),
          power(g.power, g.rate),
          duty(limits.size(), g.drive_frames, g.window_frames, g.rate)
    {
        std::transform(limits.begin(), limits.end(), strips.begin(), [](double l) {
            strip s;
            s.limit = clean_limit(l);
            s.spare = s.limit == 0.0;
            return s;
        });
        sounding.reserve(strips.size());
        powered.reserve(strips.size());
        samples.reserve(strips.size());
        frame_bytes = strips.size() * bytes_of(format);
    }

    void segment(unsigned n, std::byte* out) noexcept;
    void mix(const voice& v, bool last, unsigned n) noexcept;
    void guard(unsigned n) noexcept;
    void write(unsigned n, std::byte* out) noexcept;
    bool plays(const voice& v) const noexcept;
    void end_fades() noexcept;

    sample_format format;
    std::size_t frame_bytes = 0;
    std::vector<strip> strips;
    std::vector<std::uint32_t> sounding;
    schedule voices;
    fades fading;
    carrier_block carrier;
    power_guard power;
    drive_guard duty;
    std::vector<double*> powered; ///< sums that the power guard looks at
    std::vector<channel_samples> samples;
    std::uint64_t clock = 0; ///< frames since the construction
    std::uint64_t position = 0;
    std::uint64_t limited = 0;
    std::uint64_t power_limited = 0;
};

} // namespace tactor::synth
