// SPDX-License-Identifier: MIT
/// \file
/// Contents of the mixer: the state between blocks, and the work on one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "synth/guard/drive_guard.hpp"
#include "synth/guard/guard.hpp"
#include "synth/guard/power_guard.hpp"
#include "synth/mix/carrier.hpp"
#include "synth/mix/converter.hpp"
#include "synth/mix/fades.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/mix/score_gains.hpp"
#include "synth/mix/voice.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// A channel in the current block.
struct strip {
    alignas(64) block sum;
    const double* lone = nullptr; ///< only one voice so far: its carrier, with `gain`, in place of the sum
    double gain = 1.0;
    double limit = 0.0;
    double peak = 0.0;     ///< greatest sum of the voices
    double together = 0.0; ///< greatest sum of the voices that last until `until`, a frame of the block
    unsigned until = 0;
    unsigned since = 0;           ///< frame of the block at which the first voice begins
    unsigned look = block_frames; ///< frame of the block from which the envelope is needed
    const voice* first = nullptr; ///< valid only in the block
    double power = 1.0;           ///< greatest power of the voices' timbres
    bool steady = false;          ///< a single voice with a constant envelope
    bool beats = false;           ///< voices of several carriers
    bool only_crests = false;     ///< the envelope between the crests is not needed
    bool spare = false;           ///< no tactor: for markers
    bool sounding = false;

    /// Adds a voice's amplitude from one frame of the block to another. Voices come in order of their start.
    void reach(unsigned from, unsigned to, double amplitude) noexcept
    {
        together = from < until ? together + amplitude : amplitude;
        until = std::max(until, to);
        peak = std::max(peak, together);
    }
    /// Returns the greatest possible squared envelope.
    double most() const noexcept { return limit * limit * power; }
    /// Takes a further voice. Waves other than sines add up by their amplitudes, unless they are the same
    /// wave.
    void join(const voice& v) noexcept
    {
        steady = false;
        beats = beats || !adds_up(*first, v);
        power = v.sound != nullptr ? std::max(power, v.sound->power) : power;
    }
    /// Returns true if the channel counts as not driven in this block, whatever the voices do.
    bool is_quiet() const noexcept { return std::min(peak, limit) * std::sqrt(power) <= least_counted_drive; }
    /// Returns the sum, computed now if a single voice replaced it.
    double* summed(unsigned n) noexcept
    {
        if (lone != nullptr) {
            set_constant(lone, gain, 0, n, sum.data());
            lone = nullptr;
        }
        return sum.data();
    }
};

/// A block that keeps a cache line's alignment in a vector.
struct alignas(64) aligned_block : block {};

/// A few frames of a channel on which carriers beat.
struct crest {
    static constexpr std::size_t frames = 128;
    alignas(64) std::array<double, frames> x{}; ///< of the current carrier; zero between two
    alignas(64) std::array<double, frames> y{};
    alignas(64) std::array<double, frames> reach{}; ///< of the earlier carriers
    bool touched = false;
};

/// A score that will fade or, without a number of a fade, be cut.
struct leaver {
    std::uint32_t score = 0;
    std::int32_t fade = fades::none;
    auto operator<=>(const leaver&) const = default;
};

struct mixer::impl {
    impl(std::span<const double> limits, format_kind f, std::size_t capacity, const guard_settings& g)
        : format(f),
          strips(limits.size()),
          voices(capacity),
          power(limits.size(), g.power, most_power * reach(limits), g.rate),
          duty(limits.size(), g),
          envelopes(power.on() || duty.on() ? limits.size() : 0),
          crests(power.on() ? limits.size() : 0)
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
        leaving.reserve(most_leaving);
        carriers.reserve(power.on() ? capacity : 0);
        frame_bytes = strips.size() * sample_bytes(format);
    }

    static double reach(std::span<const double> limits) noexcept
    {
        return std::accumulate(limits.begin(), limits.end(), 0.0,
                               [](double sum, double l) { return sum + clean_limit(l) * clean_limit(l); });
    }

    /// Returns the carrier of a voice as it sounds.
    const double* shaped(const voice& v, std::uint64_t at, unsigned n, wave w) noexcept
    {
        return carrier.get(v, v.fade == fades::none ? nullptr : &fading[v.fade], gains.find(v.score, at), at,
                           n, w);
    }
    void segment(unsigned n, std::byte* out) noexcept;
    void mix(const voice& v, bool last, unsigned n) noexcept;
    void limit(unsigned n) noexcept;
    void guard(unsigned n) noexcept;
    void look_from(bool together, unsigned n) noexcept;
    void begin_strip(std::uint32_t channel, const voice& v, unsigned from) noexcept;
    void mix_line(const voice& v, const double* s, unsigned n) noexcept;
    void add_wave(const voice& v, const stretch& p, wave w, unsigned look, unsigned n, double* sum) noexcept;
    void find_envelopes(unsigned n) noexcept;
    void count_drive(unsigned n) noexcept;
    void find_beats(unsigned from, unsigned n) noexcept;
    void list_carriers() noexcept;
    void find_crests(unsigned from, unsigned to) noexcept;
    void add_carrier(unsigned from, unsigned to) noexcept;
    void cut(unsigned n) noexcept;
    void guard_power(bool together, unsigned n) noexcept;
    void write(unsigned n, std::byte* out) noexcept;
    bool plays(const voice& v) const noexcept;
    void let_go() noexcept;
    void end_fades() noexcept;

    static constexpr std::size_t most_leaving = 1024; ///< capacity of `leaving`

    format_kind format;
    std::size_t frame_bytes = 0;
    std::vector<strip> strips;
    std::vector<std::uint32_t> sounding;
    voice_list voices;
    fades fading;
    score_gains gains;
    std::vector<leaver> leaving; ///< since the last pass over the voices
    carrier_block carrier;
    power_guard power;
    drive_guard duty;
    std::vector<aligned_block> envelopes; ///< squared, by channel; empty if not needed
    std::vector<powered_channel> powered;
    std::vector<crest> crests;                              ///< by channel
    std::vector<std::pair<double, std::uint32_t>> carriers; ///< cycles per frame, index among the active
    std::vector<channel_samples> samples;
    std::uint64_t clock = 0; ///< frames since the construction
    std::uint64_t position = 0;
    std::uint64_t limited = 0;
    std::uint64_t power_limited = 0;
};

} // namespace tactor::synth
