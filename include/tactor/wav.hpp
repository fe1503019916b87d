// SPDX-License-Identifier: MIT
/// \file
/// WAV files, one channel per tactor.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include <tactor/api.hpp>
#include <tactor/render.hpp>
#include <tactor/sample_format.hpp>

namespace tactor {
inline namespace v0 {

/// Called between blocks with the frames done and in all; false gives up.
using wav_progress = std::function<bool(std::uint64_t done, std::uint64_t all)>;

/// Renders a score to a WAV file (RF64 above 4 GB) in bounded memory. Writes to a temporary name in
/// the same folder, which becomes `file` when complete; on failure, or when `progress` gives up,
/// nothing is left behind and an existing `file` stays as it was. Blocks on the file system.
/// \returns false when `progress` gave up.
/// \throws error: bad_input for a format that WAV cannot hold (s24_4), a folder that does not exist, and a
///         plan that fails in mid-stroke (renderer::failure()); runtime for what the file system refuses.
TACTOR_API bool write_wav(const score& s, format_kind f, const std::filesystem::path& file,
                          const wav_progress& progress = {});

} // namespace v0
} // namespace tactor
