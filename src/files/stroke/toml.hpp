// SPDX-License-Identifier: MIT
// Stroke files in TOML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Reads a file as parse_strokes_toml() does a text; it may name other files.
std::vector<stroke> read_strokes_file(std::string_view text, const std::string& name, double intensity_max);

} // namespace tactor::detail
