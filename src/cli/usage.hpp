// SPDX-License-Identifier: MIT
/// \file
/// What is wrong with a command line, in the tool's words.
#pragma once

#include <tactor/error.hpp>

namespace CLI {
class App;
class ParseError;
} // namespace CLI

namespace tactor::cli {

/// Turns the parser's complaint into an error that names the option and, where it is not known, the
/// nearest one that is.
error usage_error(const CLI::App& app, const CLI::ParseError& e);

} // namespace tactor::cli
