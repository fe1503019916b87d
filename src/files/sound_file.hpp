// SPDX-License-Identifier: MIT
/// \file
/// WAV files that are in memory: their parts, samples and recordings.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// A format chunk, checked.
struct wav_format {
    std::uint16_t tag = 0; ///< 1 integers, 3 floats
    std::uint16_t channels = 0;
    std::uint32_t rate = 0;
    std::uint16_t bits = 0;  ///< of a sample
    std::uint16_t bytes = 0; ///< of a sample with what fills it up
};

/// A WAV file whose header is settled: sizes that recorders left open, chunks in between and containers of
/// several kinds are gone.
struct wav_parts {
    wav_format format;
    std::string_view samples; ///< within the file
    std::uint64_t announced =
        0; ///< bytes of samples by the header; as many as there are where it leaves that open
};

/// Finds format and samples. \throws error (bad_input) with `name`.
wav_parts find_wav_parts(std::string_view file, const std::string& name);

/// Returns the first `most` samples of one channel, integers as fractions of full scale.
std::vector<float> decode_wav(const wav_parts& parts, std::size_t most);

/// Reads the bytes of a WAV file; `name` stands for it in messages. \throws error (bad_input).
recording parse_recording(std::string_view bytes, const std::string& name);

} // namespace tactor::detail
