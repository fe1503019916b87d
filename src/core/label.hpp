// SPDX-License-Identifier: MIT
/// \file
/// Short texts by which somebody names a thing for others to read: a client, the place of an array.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tactor {

/// Hint for a text that is no label.
inline constexpr const char* label_hint = "1 to 40 characters, no control characters";

/// Returns the first bytes of a text, at most so many and no part of a character.
[[nodiscard]] std::string_view first_characters(std::string_view utf8, std::size_t most_bytes);

/// Returns true for a text with control characters, or with characters that turn the direction of a line.
/// `utf8` is valid.
[[nodiscard]] bool has_controls(std::string_view utf8);

/// Returns what is wrong with a label: "is empty", "has 41 characters", "has control characters"; empty:
/// nothing. `utf8` is valid.
[[nodiscard]] std::string label_fault(std::string_view utf8);

} // namespace tactor
