// SPDX-License-Identifier: MIT
/// \file
/// drive_limits in the units of power_guard and drive_guard.
#pragma once

#include <cstdint>
#include <limits>

#include <tactor/render.hpp>

namespace tactor::synth {

/// The longest window that drive_limits may have, s.
inline constexpr double longest_window_s = 3600.0;

/// Limits in the mixer's units; as initialised: no limits.
struct guard_settings {
    double power = std::numeric_limits<double>::infinity(); ///< greatest sum of squared envelopes
    std::uint64_t drive_frames = 0;
    std::uint64_t window_frames = 0;
    unsigned rate = 48000;
};

/// \throws error (bad_input) for impossible limits.
void check_limits(const drive_limits& l);
/// Limits at a sample rate. Throws like check_limits.
guard_settings guards_of(const drive_limits& l, unsigned rate);

} // namespace tactor::synth
