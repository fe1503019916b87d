// SPDX-License-Identifier: MIT
/// \file
/// The chunks before the samples in a WAV file. All sizes are known beforehand, so that a pipe can take the
/// file.
#pragma once

#include <cstdint>
#include <string>

#include <tactor/sample_format.hpp>

#include "sink/wav/container.hpp"

namespace tactor::wav {

/// RIFF's chunks up to the first sample: fmt (18 bytes and a fact chunk for float, as the format requires for
/// everything but integer PCM), and ds64 where the container is RF64. No PEAK chunk: it holds the time of
/// day, and the same stroke would not give the same bytes. \throws error (bad_input) for a format that WAV
/// cannot hold (s24 in four bytes).
std::string header(format_kind f, container c, unsigned channels, unsigned rate, std::uint64_t frames);

/// A chunk has an even number of bytes: 1 where a byte of padding follows the samples.
constexpr unsigned padding(std::uint64_t data_bytes) noexcept
{
    return data_bytes % 2 != 0 ? 1U : 0U;
}

} // namespace tactor::wav
