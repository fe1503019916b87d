// SPDX-License-Identifier: MIT
/// \file
/// Options of the command line that fill the settings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/commands.hpp"
#include "options/option.hpp"
#include "session/environment.hpp"

namespace CLI {
class Option;
}

namespace tactor::cli {

using session::environment;
using session::settings;

/// Adds the options of the table that a command takes: `place` is its bit. Returns their values.
settings& add_options(command_line& line, std::uint64_t place);

/// Returns the first given option that is about a stream which sounds: for sessions in which nothing is
/// played. Empty: none was given.
std::string asked_of_stream(const settings& s);

/// Adds the argument STROKE, which may be given `most` times.
void add_strokes(command_line& line, int most = 1);

/// Lists the command's own options that are added next under this heading, of which --help has the names.
void begin_group(CLI::App& command, const std::string& heading = "Options");

/// --format: one of `names`, of which the first is the default. `into` must live as long as the command.
void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help);

/// --force: output replaces a file that tactor did not write.
void add_force_option(CLI::App& command, bool& into);

/// Adds an option whose text `take` reads. Returns it.
CLI::Option* add_text(CLI::App& command, const std::string& names, const std::string& type,
                      const std::string& help, const std::function<void(const std::string&)>& take);

/// Returns the place of a text among names. \throws error (bad_input) that lists them.
std::size_t choose(std::string_view option, const std::string& text, const std::vector<std::string>& names);

/// \throws error (bad_input) about an option.
[[noreturn]] void refuse_option(std::string_view option, const std::string& why, std::string_view hint);

} // namespace tactor::cli
