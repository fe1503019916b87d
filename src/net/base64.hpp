// SPDX-License-Identifier: MIT
/// \file
/// Bytes in messages of text (RFC 4648, section 4).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::net {

/// Returns the length of so many bytes in base64.
constexpr std::size_t base64_size(std::size_t bytes) noexcept
{
    return (bytes + 2) / 3 * 4;
}

/// Appends bytes in base64.
void append_base64(std::string& to, std::string_view bytes);

/// Returns the bytes; none if the text is no base64 with its padding.
std::optional<std::string> read_base64(std::string_view text);

} // namespace tactor::net
