// SPDX-License-Identifier: MIT
/// \file
/// Pages of help, errors of the command line, and a shell's completion, all from the options as declared.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>

#include "options/option.hpp"

namespace CLI {
class App;
class ParseError;
} // namespace CLI

namespace tactor::cli {

/// Makes --help fit a screen and adds --help-all, for all commands that are added later.
void use_help_pages(CLI::App& app);

/// Returns the lines with the commands to try first.
std::string first_steps();

/// Describes an option: its values, the places where it may be given and its names there; of options that
/// only some commands have, the line of their help. `given` may begin with dashes. If no option has this
/// name, lists those with it in their names. \throws error (bad_input) if there is none.
std::string describe_options(const CLI::App& app, std::string_view given);

/// Returns the error for a command line without a command.
error no_command();

/// Returns an error that names what was probably meant by the words of a refused command line: a dash or
/// quotation mark that no keyboard types, a word before the command, path data or a file's name with blanks
/// and without quotes. Nothing if there is no such slip. `commands`: names of all commands.
std::optional<error> find_slip(const std::vector<std::string>& words,
                               const std::vector<std::string>& commands);

/// Turns the parser's complaint into an error that names the option and, where it is not known, the
/// nearest one that is.
error usage_error(const CLI::App& app, const CLI::ParseError& e);

/// First argument of the hidden command that the shells' completions call: `tactor __complete WORD...`.
inline constexpr const char* complete_command = "__complete";

/// Returns lines for a shell. `words`: those after "tactor", the last one as far as it has been typed. Each
/// line is a word that begins so, a tab and a description, or ":files" where a file or a folder fits.
std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words);

} // namespace tactor::cli
