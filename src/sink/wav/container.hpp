// SPDX-License-Identifier: MIT
/// \file
/// Which of the two containers a WAV file has.
#pragma once

#include <cstdint>

namespace tactor::wav {

enum class container { wave, rf64 };

/// RF64 where the 32-bit sizes of WAVE are too small; 4096 bytes are reserved for the chunks beside the
/// samples.
constexpr container container_for(std::uint64_t frames, std::uint64_t frame_bytes) noexcept
{
    constexpr std::uint64_t most = 0xFFFFFFFFU - 4096U;
    return frame_bytes != 0 && frames > most / frame_bytes ? container::rf64 : container::wave;
}

} // namespace tactor::wav
