// SPDX-License-Identifier: MIT
/// \file
/// What the system says in its own folders, /proc and /dev. What is not there or may not be read is empty; a
/// want of descriptors is no answer. Not by std::filesystem's iterators and streams: those of libstdc++ 12
/// end the process where memory runs out, or go on with a part.
#pragma once

#include <string>
#include <vector>

namespace tactor::rt {

/// Names in a folder, in no order, without "." and "..".
/// \throws error (runtime) where there is no descriptor to be had.
std::vector<std::string> names_in(const std::string& folder);

/// A small file as a whole. Throws as names_in() does.
std::string text_of(const std::string& file);

} // namespace tactor::rt
