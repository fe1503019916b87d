// SPDX-License-Identifier: MIT
/// \file
/// An array file with another channel map.
#pragma once

#include <string>
#include <vector>

#include "cli/input.hpp"

namespace tactor::cli {

/// Whether a new file can be made there. \throws error (bad_input): there is one, or no such folder.
void check_new_file(const std::string& name);

/// Writes a new array file: the text of the one in use with other channels; where that is none, or its text
/// cannot be used from there, a file that takes the array from it. Nothing is left where it fails.
/// \throws error: bad_input as check_new_file() does, runtime when it cannot be written.
void write_channel_file(const std::string& name, const environment& e, const std::vector<unsigned>& channels);

} // namespace tactor::cli
