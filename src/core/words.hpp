// SPDX-License-Identifier: MIT
/// \file
/// Text for people: numbers in messages and captions, names and labels. Records in JSON and CSV keep every
/// digit instead. Any thread; independent of the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <tactor/waveform.hpp>

namespace tactor {

/// Returns "1 burst", "2 bursts", "0 bursts". If `plural` is empty, the plural is the noun with an s.
[[nodiscard]] std::string counted(std::uint64_t n, std::string_view noun, std::string_view plural = {});

/// Returns a number with at most `digits` (1 to 15) significant digits and no exponent: 0.07, 1200000.
/// Returns "0" for a number that is 0 when rounded to twelve decimals.
[[nodiscard]] std::string plain_number(double v, int digits = 6);

/// Returns a time with its unit: "1.26 s", "0.07 s"; "27.9 us" and "27.9 ns" below 0.0001 s. Less than half a
/// nanosecond, a rounding error, is "0 s".
[[nodiscard]] std::string seconds_text(double s, int digits = 6);

/// Returns the text with A to Z in lower case, for names that ignore case.
[[nodiscard]] std::string to_lower_case(std::string text);

/// Returns the reason why samples of more than most_own_bytes are refused: "it has 3072 MB of samples, but
/// ...".
[[nodiscard]] std::string too_large_text(std::uint64_t bytes);

/// Returns the name of a recording's file, or "recording" if it has no file.
[[nodiscard]] std::string recording_name(const recording& r);

/// Hint for a text that is not a valid label. A label is a short name that a user gives to something, such as
/// a client or the site of an array.
inline constexpr const char* label_hint = "use 1 to 40 characters, no control characters";

/// Returns the longest prefix of a text that has at most `most_bytes` bytes and does not split a character.
[[nodiscard]] std::string_view first_characters(std::string_view utf8, std::size_t most_bytes);

/// Returns the text without characters that show nothing: blanks, controls, and others that displays ignore.
/// Precondition: `utf8` is valid.
[[nodiscard]] std::string remove_invisible(std::string_view utf8);

/// Returns true if a text contains control characters, or characters that change the direction of writing.
/// Precondition: `utf8` is valid.
[[nodiscard]] bool has_controls(std::string_view utf8);

/// Returns what is wrong with a label: "is empty", "has 41 characters", "has control characters". Returns ""
/// for a valid label. Precondition: `utf8` is valid.
[[nodiscard]] std::string label_fault(std::string_view utf8);

} // namespace tactor
