// SPDX-License-Identifier: MIT
/// \file
/// Lines that fit a terminal of 80 columns.
#pragma once

#include <string>

namespace tactor::cli {

/// Breaks text at single blanks so that no line is longer than 79 characters where that can be. `first`
/// stands before the first line, as many blanks before the others.
std::string wrapped(const std::string& first, const std::string& text);

} // namespace tactor::cli
