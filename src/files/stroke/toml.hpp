// SPDX-License-Identifier: MIT
// Stroke files in TOML, and the keys that they share with array files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"
#include "files/toml_reader.hpp"

namespace tactor::detail {

/// Range of turns and angles, degrees.
inline constexpr bounds turn_deg{-3600.0, 3600.0};

/// Reads mirror and rotate_deg. Returns the map that scales by `scale`, mirrors and then turns about the
/// origin. \throws error (bad_input) with file, line and column.
affine read_turn(const toml_table& t, double scale = 1.0);

/// Reads a file as parse_strokes_toml() does a text; it may name other files.
std::vector<stroke> read_strokes_file(std::string_view text, const std::string& name, double intensity_max);

} // namespace tactor::detail
