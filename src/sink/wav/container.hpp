// SPDX-License-Identifier: MIT
/// \file
/// Which of the two files that hold waves.
#pragma once

#include <cstdint>

namespace tactor::wav {

enum class container { wave, rf64 };

/// RF64 where the 32-bit sizes of WAVE do not do; 4096 bytes are left for what stands around the samples.
constexpr container container_for(std::uint64_t frames, std::uint64_t frame_bytes) noexcept
{
    constexpr std::uint64_t most = 0xFFFFFFFFU - 4096U;
    return frame_bytes != 0 && frames > most / frame_bytes ? container::rf64 : container::wave;
}

} // namespace tactor::wav
