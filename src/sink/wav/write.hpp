// SPDX-License-Identifier: MIT
/// \file
/// write_wav with the container given: tests make small RF64 files.
#pragma once

#include <tactor/wav.hpp>

#include "sink/wav/container.hpp"

namespace tactor::wav {

bool write(const score& s, format_kind f, const std::filesystem::path& file, container c,
           const wav_progress& progress);

} // namespace tactor::wav
