// SPDX-License-Identifier: MIT
/// \file
/// Carrier of a voice, window, fade and gain included, shared by the voices that have it in common.
#pragma once

#include <array>
#include <cstdint>

#include "synth/mix/oscillator.hpp"
#include "synth/mix/score_gains.hpp"
#include "synth/mix/voice.hpp"

namespace tactor::synth {

/// Cache of the latest block: the events of one burst, or of a whole continuous stroke, need the same one.
class carrier_block {
public:
    /// Returns the samples of the n frames (at most block_frames) from frame `at` of the stream on. Valid
    /// until the next call for the same wave. `f`, `g`: null: none.
    const double* get(const voice& v, const fade* f, const score_gain* g, std::uint64_t at, unsigned n,
                      wave w = wave::sine) noexcept;
    /// Returns true if `s`, which get() returned for the sine, has no window, fade or gain.
    bool is_plain(const double* s) const noexcept { return s == entries_[0].plain.data(); }
    void forget() noexcept;

private:
    struct place {
        std::uint64_t at = ~std::uint64_t{0};
        unsigned n = 0;
        double cycles_per_frame = 0.0;
        std::uint64_t phase = 0;
        std::uint64_t stroke_place = 0;
        const timbre* sound = nullptr;
        bool operator==(const place&) const = default;
    };
    struct shape {
        std::uint64_t window_place = 0;
        burst_window window = {};
        std::int64_t fade_place = 0;
        std::uint64_t fade_length = 0;
        score_gain gain = {};
        bool operator==(const shape&) const = default;
    };
    struct entry {
        place plain_place;
        place shaped_place;
        shape shaped_shape;
        alignas(64) block plain{};
        alignas(64) block shaped{};
    };
    oscillator_tables tables_;
    std::array<entry, 2> entries_; ///< by wave
};

/// Computes sum[j] += amplitude * s[j] for those of n frames from frame `at` of the stream on that are in the
/// stretch.
void add_stretch(const double* s, const stretch& p, std::uint64_t at, unsigned n, double* sum) noexcept;

/// Computes sum[j] += a * s[j] for lo <= j < hi.
void add_constant(const double* s, double a, unsigned lo, unsigned hi, double* sum) noexcept;

/// Computes sum[j] += (a + slope * (k + j)) * s[j] for lo <= j < hi.
void add_line(const double* s, double a, double slope, double k, unsigned lo, unsigned hi,
              double* sum) noexcept;

} // namespace tactor::synth
