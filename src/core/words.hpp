// SPDX-License-Identifier: MIT
/// \file
/// Numbers as people read them, for messages and captions. Records (JSON, CSV) keep every digit instead.
/// Any thread; the same in every locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tactor {

/// "1 burst", "2 bursts", "0 bursts". `plural`: where it is not the noun and an s.
[[nodiscard]] std::string counted(std::uint64_t n, std::string_view noun, std::string_view plural = {});

/// A number with at most `digits` (1 to 15) significant digits and no exponent: 0.07, 1200000; what rounds to
/// nothing at twelve decimals is 0.
[[nodiscard]] std::string plain_number(double v, int digits = 6);

/// A time in seconds with its unit: "1.26 s", "0.07 s"; "27.9 us" and "27.9 ns" below 0.0001 s, and "0 s" for
/// less than half a nanosecond, which is what rounding leaves.
[[nodiscard]] std::string seconds_text(double s, int digits = 6);

/// Says that a live stroke plays an intensity above 1 at 1; for the first such point of a stroke.
[[nodiscard]] std::string held_text(double intensity);

/// Without the capitals of A to Z: of names that not everybody tells apart by them.
[[nodiscard]] std::string in_small_letters(std::string text);

} // namespace tactor
