// SPDX-License-Identifier: MIT
/// \file
/// Conversion of doubles to the sample formats, four neighbouring channels at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactor/choices.hpp>

namespace tactor::synth {

/// Block of one channel.
struct channel_samples {
    std::uint32_t channel = 0;
    const double* x = nullptr; ///< without NaN
    double gain = 1.0;
};

/// Writes n (at most block_frames) interleaved frames of `channels` channels: gain * x for a channel in
/// `sounding` (in order of channel), else zero. Integers are the value times 2^(bits - 1), rounded to the
/// nearest with ties to even, from -2^(bits - 1) to 2^(bits - 1) - 1. A reader that divides by 2^(bits - 1),
/// such as libsndfile, restores the value. Only 1.0 does not fit; it becomes the greatest integer. Float is
/// the nearest float. Never writes a negative zero.
void interleave(format_kind f, std::span<const channel_samples> sounding, std::size_t channels, unsigned n,
                std::byte* out) noexcept;

/// Returns the version of the loops of clones.hpp that runs on this processor: "avx-512", "avx2" or
/// "baseline".
const char* vector_path() noexcept;

} // namespace tactor::synth
