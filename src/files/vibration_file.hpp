// SPDX-License-Identifier: MIT
/// \file
/// Vibrations of other programs' files, as textures and as strokes that rest.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// Longest list of values or events of such a file.
inline constexpr std::size_t most_vibration_values = 100'000;

/// Reads a .haptic file of version 1. \throws error (bad_input).
vibration read_haptic(std::string_view text, const std::string& name);
/// Reads an AHAP file. \throws error (bad_input).
vibration read_ahap(std::string_view text, const std::string& name);

/// Reads the table [texture]: the numbers of an actuator, or the name of its file (ACF).
/// \throws error (bad_input).
actuator_numbers read_texture(const toml_table& t, const std::filesystem::path& folder);

/// Returns true for the name of a file of one of these formats.
bool names_vibration(const std::filesystem::path& file);
/// Reads a file of one of these formats as a recording. \throws error (bad_input).
recording load_vibration(const std::filesystem::path& file);

/// Returns strokes that rest in the middle of the array and play the vibration: its envelope, and one or two
/// for each emphasis.
std::vector<stroke> make_vibration_strokes(const vibration& v, const std::string& name);

} // namespace tactor::detail
