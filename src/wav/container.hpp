// SPDX-License-Identifier: MIT
/// \file
/// Which of the two files that hold waves.
#pragma once

#include <cstdint>

namespace tactor::wav {

enum class container { wave, rf64 };

/// Bytes that the headers around the samples need at most.
inline constexpr std::uint64_t header_bytes = 4096;

/// RF64 where the 32-bit sizes of WAVE do not do.
constexpr container container_for(std::uint64_t frames, std::uint64_t frame_bytes) noexcept
{
    constexpr std::uint64_t most = 0xFFFFFFFFU - header_bytes;
    return frame_bytes != 0 && frames > most / frame_bytes ? container::rf64 : container::wave;
}

} // namespace tactor::wav
