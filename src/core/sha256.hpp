// SPDX-License-Identifier: MIT
/// \file
/// SHA-256 (FIPS 180-4), for seeds from text and for identifiers of plans.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactor::detail {

using sha256_digest = std::array<std::uint8_t, 32>;

sha256_digest sha256(std::string_view bytes);

/// Returns the digest as 64 lower-case hexadecimal digits.
std::string sha256_text(std::string_view bytes);

} // namespace tactor::detail
