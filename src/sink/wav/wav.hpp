// SPDX-License-Identifier: MIT
/// \file
/// WAV files: the container, the chunks before the samples, the file. All sizes are known in advance, so a
/// pipe can take the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tactor/choices.hpp>
#include <tactor/render.hpp>

namespace tactor::wav {

enum class container { wave, rf64 };

/// Returns rf64 if the 32-bit sizes of WAVE are too small. 4096 bytes are reserved for the other chunks.
constexpr container container_for(std::uint64_t frames, std::uint64_t frame_bytes) noexcept
{
    constexpr std::uint64_t most = 0xFFFFFFFFU - 4096U;
    return frame_bytes != 0 && frames > most / frame_bytes ? container::rf64 : container::wave;
}

/// Returns RIFF's chunks up to the first sample: fmt (18 bytes and a fact chunk for float, as the format
/// requires for all but integer PCM), and ds64 if the container is RF64. No PEAK chunk: it contains the time
/// of day, so the same stroke would give other bytes.
/// `bytes_after`: those of the chunks after the samples.
/// \throws error (bad_input) for a format that WAV cannot hold (s24 in four bytes).
std::string header(format_kind f, container c, unsigned channels, unsigned rate, std::uint64_t frames,
                   std::uint64_t bytes_after = 0);

/// Returns the bytes of padding after the samples, 0 or 1: a chunk has an even number of bytes.
constexpr unsigned padding(std::uint64_t data_bytes) noexcept
{
    return data_bytes % 2 != 0 ? 1U : 0U;
}

/// Returns the bytes that write_wav() writes; `marked`: those of save().
/// \throws error (bad_input) for a format that WAV cannot hold.
std::string bytes(const score& s, format_kind f, bool marked = false);

/// Writes a file as write_wav() does, in the given container, so that tests can make small RF64 files.
/// `marked`: with a comment after the samples (LIST INFO ICMT) that has the SHA-256 of all else.
bool write(const score& s, format_kind f, const std::filesystem::path& file, container c,
           const wav_progress& progress, bool marked = false);

/// Refuses to replace a file without its right mark, unless `force`, and a file that was read as input.
/// \throws error (bad_input).
void check_output(const std::filesystem::path& file, bool force);

/// Writes a marked file. \throws error as write_wav() and check_output().
bool save(const score& s, format_kind f, const std::filesystem::path& file, bool force,
          const wav_progress& progress);

} // namespace tactor::wav
