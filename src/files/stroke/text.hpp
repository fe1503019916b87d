// SPDX-License-Identifier: MIT
// What the readers of stroke files share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tactor/error.hpp>

namespace tactor::detail {

/// Ten million timed points with all their digits; more is not a stroke but the wrong file.
inline constexpr std::size_t max_stroke_bytes = std::size_t{512} << 20;

/// Of what is kept as a tree while it is read: TOML takes some 40 bytes of memory for one of text, so a
/// million timed points fit, and 2 GB are not exceeded.
inline constexpr std::size_t max_tree_bytes = std::size_t{48} << 20;

/// \throws error (bad_input) for text longer than `max_bytes`.
void check_size(std::string_view text, const std::string& name, std::size_t max_bytes, std::string_view hint);

/// Text without a byte order mark.
std::string_view without_mark(std::string_view text) noexcept;

/// "stroke" for "dir/stroke.csv".
std::string stem(const std::string& name);

/// Line and column of an offset.
source_place place_of(std::string_view text, std::size_t offset, const std::string& name);

} // namespace tactor::detail
