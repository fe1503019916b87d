// SPDX-License-Identifier: MIT
/// \file
/// Reads /proc and /dev. A missing or forbidden file counts as empty, but a lack of descriptors throws. Does
/// not use std::filesystem's iterators and streams: those of libstdc++ 12 end the process when memory runs
/// out, or continue with a part.
#pragma once

#include <string>
#include <vector>

namespace tactor::rt {

/// Returns the names in a folder, in no order, without "." and "..".
/// \throws error (runtime) when the process has no descriptors left.
std::vector<std::string> names_in(const std::string& folder);

/// Reads a small file as a whole. Throws as names_in() does.
std::string read_file(const std::string& file);

} // namespace tactor::rt
