// SPDX-License-Identifier: MIT
/// \file
/// Four channels that lie side by side, written together: a transposition.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "synth/mix/oscillator.hpp"

namespace tactor::synth {

/// Samples of one channel, as their bits.
struct alignas(64) lane : std::array<std::uint32_t, block_frames> {};

/// Channels that are written together.
inline constexpr std::size_t abreast = 4;

/// For each of n frames, `stride` bytes apart, the low `bytes` (2 or 4) of the lanes' samples, side by side.
void write_abreast(const std::array<const lane*, abreast>& from, std::size_t bytes, unsigned n,
                   std::byte* out, std::size_t stride) noexcept;

} // namespace tactor::synth
