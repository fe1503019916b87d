// SPDX-License-Identifier: MIT
/// \file
/// What is wrong with a command line, in the tool's words.
#pragma once

#include <tactor/error.hpp>

namespace CLI {
class App;
class ParseError;
} // namespace CLI

#include <string>

#include "options/option.hpp"

namespace tactor::cli {

/// Returns what there is to know of an option: values, where it may be given and under which name.
std::string describe_option(const options::option& o);

/// Turns the parser's complaint into an error that names the option and, where it is not known, the
/// nearest one that is.
error usage_error(const CLI::App& app, const CLI::ParseError& e);

} // namespace tactor::cli
