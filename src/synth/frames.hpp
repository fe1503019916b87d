// SPDX-License-Identifier: MIT
/// \file
/// Seconds to frames (rendering model, section 7).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace tactor::synth {

/// Ramp of bursts that do not end on a zero crossing.
inline constexpr double default_ramp_s = 0.002;
/// How far from a whole number of half cycles still counts as one.
inline constexpr double half_cycle_tolerance = 0.01;
/// Longest drive in one event; longer ones are cut without a seam.
inline constexpr std::uint64_t longest_event = std::uint64_t{1} << 30;

/// Nearest frame. A tie goes up, and so does what misses a tie by the noise of its last digits:
/// otherwise o_k + d and o_(k+1), equal on paper, could end up in two frames.
inline std::uint64_t frame_at(double seconds, double rate) noexcept
{
    return static_cast<std::uint64_t>(std::floor(seconds * rate + 0.5 + 1e-6));
}

/// Frames of the raised cosine at each end of a burst of `length` frames: at most half of it.
inline std::uint32_t ramp_frames(std::optional<double> ramp_s, double duration_s, double carrier_hz,
                                 double rate, std::uint64_t length) noexcept
{
    if (!ramp_s) {
        const double half_cycles = 2.0 * duration_s * carrier_hz;
        const double whole = std::round(half_cycles);
        const bool ends_on_zero = whole >= 1.0 && std::abs(half_cycles - whole) <= half_cycle_tolerance;
        ramp_s = ends_on_zero ? 0.0 : default_ramp_s;
    }
    const std::uint64_t frames = frame_at(*ramp_s, rate);
    return static_cast<std::uint32_t>(std::min({frames, length / 2, longest_event}));
}

} // namespace tactor::synth
