// SPDX-License-Identifier: MIT
/// \file
/// Pages of help, and errors about the command line. Both are made from the declared options.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tactor/error.hpp>

#include "options/option.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

/// Parses the words. Prints the help or the version if they request it.
/// \throws error (bad_input) that names the option. If the option is unknown, the error suggests the most
///         similar option. CLI::Success after printing.
void parse_words(CLI::App& app, const std::vector<std::string>& words);

/// Returns a page of help that fits on a screen. It explains the options that only this command has, and
/// those that most people need. It lists only the names of the other options. If `whole` is true, it explains
/// all options.
std::string help_page(const CLI::App& app, bool whole);

/// Returns lines with commands that a new user may try.
std::string first_steps();

/// Help about an option: its values, the places where it may be set, and its name there. If only a few
/// commands have the option, the text is the line from their help. For a key of files, the text is from the
/// manual. If no option or key has this name, the text lists the options and keys whose names contain it.
class option_help {
public:
    /// Constructs the help for `word`, a name that may begin with dashes.
    explicit option_help(const std::string& word);

    void add(const CLI::App& command);
    /// Returns the help. \throws error (bad_input) if no option or key matches.
    std::string text(const CLI::App& app) const;

private:
    std::string word_;
    std::string name_;
    const options::option* row_;
    std::string text_;
    std::vector<std::string> options_;           ///< names of all options
    std::map<std::string, std::string> similar_; ///< lines of --help, by the option's name
};

/// Returns the error for a command line without a command.
error missing_command_error();

/// Looks for a typing mistake in a command line that was refused. It may be a dash or quotation mark that
/// keyboards do not type, a word before the command, or path data or a file name with blanks but without
/// quotes. Returns an error with the probable meaning, or nothing if there is no such mistake. `commands` are
/// the names of all commands.
std::optional<error> find_typing_mistake(const std::vector<std::string>& words,
                                         const std::vector<std::string>& commands);

} // namespace tactor::cli
