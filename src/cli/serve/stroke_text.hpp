// SPDX-License-Identifier: MIT
/// \file
/// STROKE arguments and options as parameters of `play`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/settings.hpp"
#include "net/rpc.hpp"

namespace tactor::cli {

/// Of each STROKE its name and the parameter that says it: a preset, path data, or the text of a file.
/// \throws error (bad_input), also for plans, which a server does not take.
std::vector<std::pair<std::string, net::json>> stroke_params(const settings& s);

/// The options that the command line gives, as parameter; the server's owner has said the others.
net::json client_options(const settings& s);

} // namespace tactor::cli
