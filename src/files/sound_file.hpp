// SPDX-License-Identifier: MIT
/// \file
/// Readers of WAV files in memory.
#pragma once

#include <string>
#include <string_view>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Reads a WAV file with one channel. `name` is its name in messages. \throws error (bad_input).
recording parse_recording(std::string_view bytes, const std::string& name);

/// Reads a WAV file with all its channels. \throws error (bad_input).
own_samples parse_samples(std::string_view bytes, const std::string& name);

} // namespace tactor::detail
