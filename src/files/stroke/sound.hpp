// SPDX-License-Identifier: MIT
/// \file
/// What a stroke of a TOML file says of its sound.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// The keys that read_sound() knows.
inline constexpr std::array<std::string_view, 7> sound_keys{
    "waveform", "am_hz", "am_depth", "noise_seed", "texture", "texture_mm", "carrier_profile"};

/// Fills them in; what is not said stays. WAV files are looked for in a folder; null: the text is no file's,
/// may come from anywhere, and may name none. \throws error with file, line and column.
void read_sound(const toml_table& t, const std::filesystem::path* folder, stroke& s);

/// parse_strokes_toml() of a file, which may name others.
std::vector<stroke> strokes_of_toml_file(std::string_view text, const std::string& name);

} // namespace tactor::detail
