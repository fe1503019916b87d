// SPDX-License-Identifier: MIT
/// \file
/// Words of the tool and of a server: STROKE arguments and options as parameters of `play`, faults as the
/// tool writes them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tactor/error.hpp>

#include "cli/settings.hpp"
#include "net/rpc.hpp"

namespace tactor::cli {

/// Rewords an error of a server. `argument`: the stroke that was sent, the name of a file or a preset, which
/// the error names before a place in a file.
error in_words_of_the_tool(const error& e, const std::string& argument);

/// Returns the name of each STROKE and its parameter: a preset, path data, or the text of a file.
/// \throws error (bad_input), also for plans, which a server does not take.
std::vector<std::pair<std::string, net::json>> stroke_params(const settings& s);

/// Returns the options that the command line gives, as a parameter. The server's owner sets the others.
net::json client_options(const settings& s);

} // namespace tactor::cli
