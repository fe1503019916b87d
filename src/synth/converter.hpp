// SPDX-License-Identifier: MIT
/// \file
/// Doubles to the sample formats.
#pragma once

#include <cstddef>

#include <tactor/sample_format.hpp>

namespace tactor::synth {

/// Writes n samples (at most block_frames) to out, out + stride, ... Integers are x * 2^(bits - 1), rounded
/// to the nearest with ties to even, from -2^(bits - 1) to 2^(bits - 1) - 1: readers that divide by 2^(bits -
/// 1), as libsndfile does, get x back. 1.0 is the one value that does not fit; it becomes the greatest
/// integer. Float is the nearest float. Never a negative zero. x must not hold NaN.
void convert(sample_format f, const double* x, unsigned n, std::byte* out, std::size_t stride) noexcept;

} // namespace tactor::synth
