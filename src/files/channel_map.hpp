// SPDX-License-Identifier: MIT
// An array file's channels changed in its own text.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace tactor::detail {

/// The text of an array or configuration file with other channels, one for each tactor in order; all else in
/// it stays as it is, comments too. May block on the file system.
/// \throws error (bad_input): what load_setup() throws; no array in the file; a wrong number of channels;
///         channels that the file cannot have (two alike, more than [output] says). The text itself is
///         checked: what it says is what was asked for.
std::string with_channels(const std::filesystem::path& file, std::span<const unsigned> channels);

} // namespace tactor::detail
