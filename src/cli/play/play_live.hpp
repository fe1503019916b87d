// SPDX-License-Identifier: MIT
/// \file
/// `play --live -`: lines on standard input move a stroke.
#pragma once

#include "cli/play/play_options.hpp"
#include "cli/settings.hpp"

namespace tactor::cli {

/// Refuses what a live stroke does not know. \throws error (bad_input).
void check_live(const settings& s);

/// Plays here, until the input ends; the exit status. \throws error.
int play_live(settings& s, const play_options& o);

} // namespace tactor::cli
