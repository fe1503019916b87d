// SPDX-License-Identifier: MIT
/// \file
/// Options that a file of strokes can say, the command line that says the rest, and names of such files.
#pragma once

#include <string>
#include <string_view>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "options/option.hpp"

namespace tactor::server {

/// Names in a command line of the tool; empty: none.
struct tool_files {
    std::string array = {}; ///< preset or file
    std::string config = {};
};

/// Gives a stroke the options that differ from the built-in ones or that a client gave, as far as a stroke
/// file has keys for them and the stroke does not say them itself.
void put_options(stroke& k, const options::wishes& s);

/// Returns " --array palm-3x3 --level-dbfs -15": what a command of the tool needs to do the same as these
/// options. `file_says`: put_options() has said what it can.
std::string option_words(const options::wishes& s, options::place command, const array& a,
                         const tool_files& files, bool file_says);

/// Returns a word as a shell reads it.
std::string quote_word(std::string_view word);

/// Returns true for 1 to 100 bytes of letters, digits, blanks, - and _, of which the first is no - and
/// neither the first nor the last is a blank. Characters beyond ASCII are letters, but for those that
/// has_controls() finds. `name` is valid UTF-8.
bool is_file_name(std::string_view name);

/// Returns the name with _ for each character that is_file_name() does not allow; "stroke" for an empty one.
std::string make_file_name(std::string_view name);

} // namespace tactor::server
