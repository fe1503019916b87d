// SPDX-License-Identifier: MIT
/// \file
/// What a shell may offer while a command line is typed: from the options as they are, so that nothing is
/// written down twice.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tactor::cli {

/// First argument of the hidden command that the shells' completions call: `tactor __complete WORD...`.
inline constexpr const char* complete_command = "__complete";

/// Lines for a shell. `words`: those after "tactor", the last one as far as it has been typed. Each line is a
/// word that begins so, a tab and a description, or ":files" with the extensions of files that fit besides.
std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words);

} // namespace tactor::cli
