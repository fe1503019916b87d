// SPDX-License-Identifier: MIT
/// \file
/// What a drive vibrates with, where that is not one sine. Made before anything sounds, then only read: the
/// audio thread gets a pointer to it, and who hands over the drives keeps it until they are over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/mix/oscillator.hpp"

namespace tactor::synth {

/// A stretch of a carrier whose frequency is linear, in frames of the carrier.
struct course_part {
    double start = 0.0;
    double cycles = 0.0;           ///< at `start`, less whole ones
    double cycles_per_frame = 0.0; ///< there
    double half_slope = 0.0;       ///< half of its change from frame to frame
    bool rests() const noexcept { return cycles_per_frame == 0.0 && half_slope == 0.0; }
};

/// Of any wave between -1 and 1.
inline constexpr double most_power = 2.0;

/// Points of a cycle, or frames of a loop.
using wave_samples = std::vector<float>;

struct timbre {
    enum class form_kind : unsigned char {
        sine,  ///< with a course, or modulated
        cycle, ///< a table of one cycle
        loop,  ///< samples at the rate of the stream
    };
    form_kind form = form_kind::sine;
    std::shared_ptr<const wave_samples> samples = {};
    double cycles_per_frame = 0.0;        ///< without a course
    std::vector<course_part> course = {}; ///< in order of start, the first from 0 or before
    double power = 1.0; ///< twice the mean square where the peak is 1, but at least 1, the square of the peak
    double am_cycles_per_frame = 0.0;
    double am_depth = 0.0;

    bool is_sine() const noexcept { return form == form_kind::sine; }
    /// out[j] is the sample of frame first + j for j < n, at most block_frames; -1 to 1. Modulation is not in
    /// it. A cosine is what makes an envelope of it: sin^2 + cos^2 = power.
    void fill(std::int64_t first, unsigned n, double* out, wave w) const noexcept;
};

/// Points beside a cycle's that interpolation needs: one before, and two and a last after.
inline constexpr std::size_t cycle_margin = 4;

/// out[j] = the cycle at place turns[j], any number of turns below 1e15, between four points by Lagrange.
void read_cycle(const wave_samples& cycle, const double* turns, unsigned n, double* out) noexcept;

/// out[j] *= (1 + depth sin(2 pi f (first + j))) / (1 + depth).
void modulate_block(oscillator_tables& tables, double cycles_per_frame, double depth, std::int64_t first,
                    unsigned n, double* out) noexcept;

} // namespace tactor::synth
