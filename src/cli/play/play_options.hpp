// SPDX-License-Identifier: MIT
/// \file
/// `play`: its own options, and its strokes that come live or go through a server.
#pragma once

#include <optional>
#include <string>

#include "cli/settings.hpp"

namespace tactor::cli {

struct play_options {
    std::optional<std::string> socket = {}; ///< of a server to play through; here where none is named
    std::string format = "text";

    bool json() const { return format == "json"; }
};

/// Refuses what a live stroke does not know. \throws error (bad_input).
void check_live(const settings& s);

/// Plays here, until the input ends; the exit status. \throws error.
int play_live(settings& s, const play_options& o);

/// Plays all STROKEs, one after the other; the exit status. \throws error, also for options that are the
/// server's owner's alone.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
