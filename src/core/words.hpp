// SPDX-License-Identifier: MIT
/// \file
/// Texts for people: numbers in messages and captions (records in JSON and CSV keep every digit instead),
/// names and labels. Any thread; the same in every locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <tactor/waveform.hpp>

namespace tactor {

/// Returns "1 burst", "2 bursts", "0 bursts". `plural` replaces the noun with an s.
[[nodiscard]] std::string counted(std::uint64_t n, std::string_view noun, std::string_view plural = {});

/// Returns a number with at most `digits` (1 to 15) significant digits and no exponent: 0.07, 1200000. A
/// number that rounds to 0 at twelve decimals is 0.
[[nodiscard]] std::string plain_number(double v, int digits = 6);

/// Returns a time with its unit: "1.26 s", "0.07 s"; "27.9 us" and "27.9 ns" below 0.0001 s. Less than half a
/// nanosecond, the remainder of rounding, is "0 s".
[[nodiscard]] std::string seconds_text(double s, int digits = 6);

/// Returns the text with A to Z in lower case, for names that ignore case.
[[nodiscard]] std::string in_small_letters(std::string text);

/// Returns the reason against samples of one's own above most_own_bytes: "it has 3072 MB of samples, but
/// ...".
[[nodiscard]] std::string too_large_text(std::uint64_t bytes);

/// Returns the recording's file, or "recording" if it has none.
[[nodiscard]] std::string recording_name(const recording& r);

/// Hint for a text that is not a label. A label is a short name that a user gives to a thing, such as a
/// client or the place of an array.
inline constexpr const char* label_hint = "use 1 to 40 characters, no control characters";

/// Returns the longest beginning of a text that has at most `most_bytes` bytes and ends with a whole
/// character.
[[nodiscard]] std::string_view first_characters(std::string_view utf8, std::size_t most_bytes);

/// Returns true for a text with control characters, or with characters that turn the direction of a line.
/// `utf8` is valid.
[[nodiscard]] bool has_controls(std::string_view utf8);

/// Returns what is wrong with a label: "is empty", "has 41 characters", "has control characters"; empty:
/// nothing. `utf8` is valid.
[[nodiscard]] std::string label_fault(std::string_view utf8);

} // namespace tactor
