// SPDX-License-Identifier: MIT
/// \file
/// Doubles to the sample formats, four neighbouring channels at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactor/choices.hpp>

namespace tactor::synth {

/// A channel's part of a block.
struct channel_samples {
    std::uint32_t channel = 0;
    const double* x = nullptr; ///< must not hold NaN
    double gain = 1.0;
};

/// Writes n (at most block_frames) interleaved frames of `channels` channels: gain * x for a channel that is
/// in `sounding` (in order of channel), else zero. Integers are the value times 2^(bits - 1), rounded to the
/// nearest with ties to even, from -2^(bits - 1) to 2^(bits - 1) - 1: readers that divide by 2^(bits - 1), as
/// libsndfile does, get it back. 1.0 is the one value that does not fit; it becomes the greatest integer.
/// Float is the nearest float. Never a negative zero.
void interleave(format_kind f, std::span<const channel_samples> sounding, std::size_t channels, unsigned n,
                std::byte* out) noexcept;

/// Returns which of the loops that clones.hpp compiles runs on this processor: "avx-512", "avx2" or
/// "baseline".
const char* vector_path() noexcept;

} // namespace tactor::synth
