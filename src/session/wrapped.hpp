// SPDX-License-Identifier: MIT
/// \file
/// Text that fits the terminal it is printed on.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace tactor::session {

/// Returns the columns that a line printed to `to` may have: its terminal's, from 40 to 200, less one. Where
/// `to` is no terminal, or one that does not know its size, 79.
std::size_t line_width(std::FILE* to);

/// Breaks text at blanks so that no line has more than `width` columns where that can be. `first` stands
/// before the first line, as many blanks before the others.
std::string wrapped(std::string_view first, std::string_view text, std::size_t width = line_width(stdout));

/// Breaks each line of `text` like wrapped(). A line goes on below its last column of words, as in a table
/// or a list of options, or below its own beginning. If that column lies in the right half of the width, its
/// words go below the others.
std::string wrap_lines(std::string_view text, std::size_t width);

/// Returns `text` as it is printed to `to`: on a terminal wrap_lines(), else unchanged.
std::string fit_lines(std::FILE* to, std::string text);

} // namespace tactor::session
