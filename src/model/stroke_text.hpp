// SPDX-License-Identifier: MIT
// What the readers of stroke files share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Ten million timed points; more is not a stroke but the wrong file.
inline constexpr std::size_t max_stroke_bytes = std::size_t{512} << 20;

/// \throws error (bad_input) for text longer than max_stroke_bytes.
void check_size(std::string_view text, const std::string& name);

/// Text without a byte order mark.
std::string_view without_mark(std::string_view text) noexcept;

/// "stroke" for "dir/stroke.csv".
std::string stem(const std::string& name);

/// Line and column of an offset.
source_place place_of(std::string_view text, std::size_t offset, const std::string& name);

} // namespace tactor::detail
