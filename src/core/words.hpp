// SPDX-License-Identifier: MIT
/// \file
/// Numbers for people, in messages and captions. Records (JSON, CSV) keep every digit instead. Any thread;
/// the same in every locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

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

} // namespace tactor
