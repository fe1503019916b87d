// SPDX-License-Identifier: MIT
/// \file
/// WAV files in memory.
#pragma once

#include <string>
#include <string_view>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Reads the bytes of a WAV file; `name` stands for it in messages. \throws error (bad_input).
recording parse_recording(std::string_view bytes, const std::string& name);

/// Reads all channels of such a file. \throws error (bad_input).
own_samples parse_samples(std::string_view bytes, const std::string& name);

} // namespace tactor::detail
