// SPDX-License-Identifier: MIT
/// \file
/// The last guard of a tactor, and drive_limits in the units of power_guard and drive_guard.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include <tactor/render.hpp>

namespace tactor::synth {

/// Limits in the mixer's units; as initialised: no limits.
struct guard_settings {
    double power = std::numeric_limits<double>::infinity(); ///< greatest sum of squared envelopes
    double drive_frames = 0.0;                              ///< longest drive; 0: drive time is not counted
    double leak = 1.0; ///< frames of drive time that a frame of rest takes away
    unsigned rate = 48000;
};

/// Converts limits to a sample rate.
/// \throws error (bad_input) for impossible limits.
guard_settings make_guards(const drive_limits& l, unsigned rate);

/// Limits n samples to -limit ... limit; NaN becomes 0. Returns the number of changed samples, not counting
/// rounding noise.
std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept;

/// Returns true if limit_block() cannot change samples of at most `peak`; false for NaN.
inline bool within_limit(double peak, double limit) noexcept
{
    return peak <= limit * (1.0 - 1e-12);
}

/// Returns the limit, clamped to 0 ... 1; NaN becomes 0.
inline double clean_limit(double l) noexcept
{
    return l > 0.0 ? std::min(l, 1.0) : 0.0;
}

} // namespace tactor::synth
