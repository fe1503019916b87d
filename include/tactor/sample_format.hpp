// SPDX-License-Identifier: MIT
/// \file
/// Sample formats, all little-endian.
#pragma once

#include <cstddef>
#include <string_view>

#include <tactor/api.hpp>

namespace tactor {

enum class sample_format {
    float32, ///< FLOAT_LE, full scale 1.0
    s16,     ///< S16_LE
    s24_3,   ///< S24_3LE: packed in three bytes, as in WAV files
    s24_4,   ///< S24_LE: right-aligned in four bytes
    s32,     ///< S32_LE
};

/// Bytes of one sample.
TACTOR_API std::size_t bytes_of(sample_format f) noexcept;

/// "float", "s16", "s24" (s24_3), "s24-4", "s32".
TACTOR_API std::string_view to_string(sample_format f) noexcept;
/// The format that prints so. \throws error (bad_input) that lists the names.
TACTOR_API sample_format sample_format_from_string(std::string_view name);

} // namespace tactor
