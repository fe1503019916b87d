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
/// the option and, where it is not known, the nearest one that is; CLI::Success after a print.
void parse_words(CLI::App& app, const std::vector<std::string>& words);

/// Returns a page of help that fits a screen: the options that a command alone has and those that most people
/// need, with their meaning; of the others the names. `whole`: with the meaning of all.
std::string help_page(const CLI::App& app, bool whole);

/// Returns the lines with the commands to try first.
std::string first_steps();

/// Description of an option: its values, the places where it may be given and its names there; of options
/// that only some commands have, the line of their help. If no option has this name, a list of those with it
/// in their names.
class option_help {
public:
    /// `word`: the name, which may begin with dashes.
    explicit option_help(const std::string& word);

    /// Adds the options of a command.
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

/// Returns an error that names what was probably meant by the words of a refused command line: a dash or
/// quotation mark that no keyboard types, a word before the command, path data or a file's name with blanks
/// and without quotes. Nothing if there is no such slip. `commands`: names of all commands.
std::optional<error> find_slip(const std::vector<std::string>& words,
                               const std::vector<std::string>& commands);

} // namespace tactor::cli
