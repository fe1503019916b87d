// SPDX-License-Identifier: MIT
/// \file
/// Sample formats, all little-endian.
#pragma once

#include <cstddef>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

enum class format_kind {
    float32, ///< FLOAT_LE, full scale 1.0
    s16,     ///< S16_LE
    s24_3,   ///< S24_3LE: packed in three bytes, as in WAV files
    s24_4,   ///< S24_LE: right-aligned in four bytes
    s32,     ///< S32_LE
};

/// Bytes of one sample.
[[nodiscard]] TACTOR_API std::size_t bytes_of(format_kind f) noexcept;

/// "float", "s16", "s24" (s24_3), "s24-4", "s32".
TACTOR_KIND(format_kind);

} // namespace v0
} // namespace tactor
