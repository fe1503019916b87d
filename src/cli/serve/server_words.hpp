// SPDX-License-Identifier: MIT
/// \file
/// What a server says of a parameter, in the words of the command line.
#pragma once

#include <string>

#include <tactor/error.hpp>

namespace tactor::cli {

/// `argument` is the stroke that was sent, a file's name or a preset's: of a place in a file, the error has
/// it.
error in_words_of_the_tool(const error& e, const std::string& argument);

} // namespace tactor::cli
