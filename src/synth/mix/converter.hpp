// SPDX-License-Identifier: MIT
/// \file
/// Conversion of doubles to the sample formats, four neighbouring channels at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactor/choices.hpp>

namespace tactor::synth {

/// Samples of one channel in a block.
struct channel_samples {
    std::uint32_t channel = 0;
    const double* x = nullptr; ///< NaN becomes silence
    double gain = 1.0;
};

/// Writes n interleaved frames (at most block_frames) of `channels` channels: gain * x for the channels in
/// `sounding`, which are in ascending order, and zero for the others. Integers are the value times 2^(bits -
/// 1), rounded to the nearest with ties to even. A reader that divides by 2^(bits - 1), such as libsndfile,
/// restores the value. Only 1.0 does not fit; it becomes the greatest integer, 2^(bits - 1) - 1. Floats are
/// the nearest float. Never writes a negative zero.
void interleave(format_kind f, std::span<const channel_samples> sounding, std::size_t channels, unsigned n,
                std::byte* out) noexcept;

/// Returns the version of the loops of clones.hpp that runs on this processor: "avx-512", "avx2" or
/// "baseline".
const char* vector_loop_version() noexcept;

} // namespace tactor::synth
