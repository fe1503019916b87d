// SPDX-License-Identifier: MIT
/// \file
/// Ramps of a burst and fade of a score.
#pragma once

#include <cstdint>

#include <tactor/render.hpp>

#include "synth/wave/oscillator.hpp"

namespace tactor::synth {

/// Window of a burst of `length` frames: it rises in its first `attack` frames and falls in its last
/// `release` frames, which do not overlap.
struct burst_window {
    std::uint64_t length = 0;
    std::uint32_t attack = 0;
    std::uint32_t release = 0;
    envelope_kind shape = envelope_kind::raised_cosine;
    bool operator==(const burst_window&) const = default;
};

/// Returns frame k of a window. A raised cosine is (1 - cos(pi k / attack)) / 2 for k < attack, (1 - cos(pi
/// (length - k) / release)) / 2 for the last `release` frames, 1 between them and 0 outside. For planning;
/// the mixer uses window_block().
double window_at(std::int64_t k, const burst_window& w) noexcept;

/// Returns true if the window is 1 in frames from ... to - 1.
bool window_is_flat(std::int64_t from, std::int64_t to, const burst_window& w) noexcept;

/// Computes out[j] *= w(first + j) for lo <= j < hi.
void window_block(oscillator_tables& tables, std::int64_t first, const burst_window& w, unsigned lo,
                  unsigned hi, double* out) noexcept;

/// Computes out[j] *= (1 + cos(pi k / length)) / 2 with k = first + j for lo <= j < hi. The factor is 1 for k
/// < 0 and 0 for k > length.
void fade_block(oscillator_tables& tables, std::int64_t first, std::uint64_t length, unsigned lo, unsigned hi,
                double* out) noexcept;

} // namespace tactor::synth
