// SPDX-License-Identifier: MIT
/// \file
/// Slips of a command line that its words show, whatever complaint they led to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/error.hpp>

namespace tactor::cli {

/// Returns an error that names what was probably meant by the words of a refused command line: a dash or
/// quotation mark that no keyboard types, a word before the command, path data or a file's name with blanks
/// and without quotes. Nothing if there is no such slip. `commands`: names of all commands.
std::optional<error> find_slip(const std::vector<std::string>& words,
                               const std::vector<std::string>& commands);

} // namespace tactor::cli
