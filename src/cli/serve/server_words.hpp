// SPDX-License-Identifier: MIT
/// \file
/// The tool's words and a server's: STROKE arguments and options as parameters of `play`, faults as the tool
/// says them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tactor/error.hpp>

#include "cli/settings.hpp"
#include "net/rpc.hpp"

namespace tactor::cli {

/// `argument` is the stroke that was sent, a file's name or a preset's: of a place in a file, the error has
/// it.
error in_words_of_the_tool(const error& e, const std::string& argument);

/// Of each STROKE its name and the parameter that says it: a preset, path data, or the text of a file.
/// \throws error (bad_input), also for plans, which a server does not take.
std::vector<std::pair<std::string, net::json>> stroke_params(const settings& s);

/// The options that the command line gives, as parameter; the server's owner has said the others.
net::json client_options(const settings& s);

} // namespace tactor::cli
