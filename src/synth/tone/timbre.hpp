// SPDX-License-Identifier: MIT
/// \file
/// Wave of a drive other than a plain sine. It is made before anything sounds, and only read afterwards. The
/// audio thread gets a pointer; the side that hands over the drives keeps the wave until the drives are over.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "synth/wave/oscillator.hpp"

namespace tactor::synth {

/// A stretch of a carrier whose frequency is linear or bent, in frames of the stroke.
struct course_part {
    double start = 0.0;
    double cycles = 0.0;           ///< at `start`, without whole cycles
    double cycles_per_frame = 0.0; ///< at `start`
    double half_slope = 0.0;       ///< half of the change of cycles_per_frame in a frame
    double frames = 0.0;           ///< length of a bent stretch; 0 if the stretch is linear
    /// Cycles of a bent stretch since its start: a polynomial in u, from 0 at its start to 1 at its end,
    /// without the constant.
    std::array<double, 6> bent = {};
    bool rests() const noexcept { return frames == 0.0 && cycles_per_frame == 0.0 && half_slope == 0.0; }
};

/// Upper bound of `power` for any wave between -1 and 1.
inline constexpr double most_power = 2.0;

struct own_channel;

/// Points of a cycle, or frames of a loop.
using wave_samples = std::vector<float>;

struct timbre {
    enum class form_kind : unsigned char {
        sine,  ///< modulated, or with a varying frequency
        cycle, ///< a table of one cycle
        loop,  ///< samples at the rate of the stream
        own,   ///< the user's own samples, unchanged
    };
    form_kind form = form_kind::sine;
    std::shared_ptr<const wave_samples> samples = {};
    std::shared_ptr<const own_channel> own = {};
    double cycles_per_frame = 0.0;        ///< cycles per frame without a course
    std::vector<course_part> course = {}; ///< in order of start; the first part starts at 0 or before
    double power = 1.0; ///< twice the mean square at peak 1; at least 1, the square of the peak
    double am_cycles_per_frame = 0.0;
    double am_depth = 0.0;

    bool is_sine() const noexcept { return form == form_kind::sine; }
    /// Returns true if a constant amplitude makes a constant envelope.
    bool is_steady() const noexcept { return form != form_kind::own; }
    /// Computes out[j], the sample of the stroke's frame first + j, for j < n (at most block_frames). Samples
    /// are in -1 ... 1, without the modulation. The carrier's phase is 0 at frame `origin`, which a loop
    /// ignores. With wave::cosine, computes the samples that complete the envelope: sin^2 + cos^2 = power, or
    /// the envelope of own_channel.
    void fill(std::int64_t first, std::int64_t origin, unsigned n, double* out, wave w) const noexcept;
};

/// Extra samples for interpolation: one before the cycle, three after it.
inline constexpr std::size_t cycle_margin = 4;

/// Computes out[j], the cycle at place turns[j], by Lagrange interpolation of four points. Turns must be
/// below 1e15.
void read_cycle(const wave_samples& cycle, const double* turns, unsigned n, double* out) noexcept;

/// Computes out[j] *= (1 + depth sin(2 pi f (first + j))) / (1 + depth).
void modulate_block(oscillator_tables& tables, double cycles_per_frame, double depth, std::int64_t first,
                    unsigned n, double* out) noexcept;

} // namespace tactor::synth
