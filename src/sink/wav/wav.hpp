// SPDX-License-Identifier: MIT
/// \file
/// WAV files: the container, the chunks before the samples, the whole file. All sizes are known in advance,
/// so a file can go to a pipe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tactor/choices.hpp>
#include <tactor/render.hpp>

namespace tactor::wav {

enum class container { wave, rf64 };

/// Returns rf64 if the 32-bit sizes of WAVE are too small. 4096 bytes are reserved for the other chunks.
constexpr container choose_container(std::uint64_t frames, std::uint64_t frame_bytes) noexcept
{
    constexpr std::uint64_t most = 0xFFFFFFFFU - 4096U;
    return frame_bytes != 0 && frames > most / frame_bytes ? container::rf64 : container::wave;
}

/// Returns the file up to the first sample. It contains ds64, if the container is RF64, and fmt. For float,
/// fmt has 18 bytes and a fact chunk follows, as the format requires for all but integer PCM. There is no
/// PEAK chunk, because it contains the time of day, so the same stroke would give other bytes. `bytes_after`:
/// size of the chunks after the samples.
/// \throws error (bad_input) for a format that WAV cannot hold (s24 in four bytes).
std::string header(format_kind f, container c, unsigned channels, unsigned rate, std::uint64_t frames,
                   std::uint64_t bytes_after = 0);

/// Returns the number of padding bytes after the samples, 0 or 1: a chunk has an even number of bytes.
constexpr unsigned padding(std::uint64_t data_bytes) noexcept
{
    return data_bytes % 2 != 0 ? 1U : 0U;
}

/// Returns the bytes that write_wav() writes, or save() if `marked`.
/// \throws error (bad_input) for a format that WAV cannot hold.
std::string bytes(const score& s, format_kind f, bool marked = false);

/// Writes a file as write_wav() does, in the given container, so that tests can make small RF64 files.
/// `marked`: adds a comment after the samples (LIST INFO ICMT) with the SHA-256 of the rest of the file.
bool write(const score& s, format_kind f, const std::filesystem::path& file, container c,
           const wav_progress& progress, bool marked = false);

/// Refuses to replace a file that was read as input and, unless `force`, a file without a valid mark.
/// \throws error (bad_input).
void check_output(const std::filesystem::path& file, bool force);

/// Writes a marked file. \throws error as write_wav() and check_output().
bool save(const score& s, format_kind f, const std::filesystem::path& file, bool force,
          const wav_progress& progress);

} // namespace tactor::wav
