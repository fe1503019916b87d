// SPDX-License-Identifier: MIT
/// \file
/// Bytes in messages of text (RFC 4648, section 4).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tactor::net {

/// Appends bytes in base64.
void append_base64(std::string& to, std::string_view bytes);

/// Returns the bytes; none if the text is no base64 with its padding.
std::optional<std::string> read_base64(std::string_view text);

} // namespace tactor::net
