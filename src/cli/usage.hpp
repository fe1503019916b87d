// SPDX-License-Identifier: MIT
/// \file
/// Pages of help, and errors of the command line, from the options as declared.
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

/// Parses the words. Prints the help or the version if they ask for it. \throws error (bad_input) that names
/// the option, and for an unknown option the nearest known one; CLI::Success after printing.
void parse_words(CLI::App& app, const std::vector<std::string>& words);

/// Returns a page of help that fits a screen. It explains the options that only this command has and those
/// that most people need, and lists the names of the others. `whole`: explains all options.
std::string help_page(const CLI::App& app, bool whole);

/// Returns the lines with the commands to try first.
std::string first_steps();

/// Help about an option: its values, where it may be set, and its name there; for an option of a few
/// commands, the line of their help. For a key of files, what the manual says. If no option or key has this
/// name, the options whose names contain it.
class option_help {
public:
    /// `word`: the name, which may begin with dashes.
    explicit option_help(const std::string& word);

    void add(const CLI::App& command);
    /// \throws error (bad_input) if there is no such option.
    std::string text(const CLI::App& app) const;

private:
    std::string word_;
    std::string name_;
    const options::option* row_;
    std::string text_;
    std::map<std::string, std::string> similar_; ///< lines of --help by name
};

/// Returns the error for a command line without a command.
error no_command();

/// Looks for a slip in a refused command line: a dash or quotation mark that no keyboard types, a word before
/// the command, or path data or a file's name with blanks but without quotes. Returns an error that says what
/// was probably meant; nothing if there is no slip. `commands`: names of all commands.
std::optional<error> find_slip(const std::vector<std::string>& words,
                               const std::vector<std::string>& commands);

} // namespace tactor::cli
