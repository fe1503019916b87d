// SPDX-License-Identifier: MIT
/// \file
/// `play` through a server: what is given on the command line, in the protocol's words.
#pragma once

#include "cli/play/play_options.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {

/// Plays all STROKEs, one after the other; the exit status. \throws error, also for options that are the
/// server's owner's alone.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
