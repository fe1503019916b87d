// SPDX-License-Identifier: MIT
/// \file
/// The walk: sounds, questions and answers.
#pragma once

#include <string>
#include <vector>

#include "cli/input.hpp"
#include "session/play_session.hpp"
#include "session/walk.hpp"

namespace tactor::cli {

struct walk_options {
    session::stream_options stream;
    bool json = false; ///< questions go to standard error
    double carrier_hz = 250.0;
    bool ask = true; ///< false: each is only named
};

struct walk_result {
    int signal = 0; ///< signal that ended it, or 0
    session::walk_answers felt;
};

/// Drives each tactor and asks where it was felt, on standard input. Questions go to standard output, or to
/// standard error if that is JSON.
/// \throws error: errors of play; runtime when the walk is left before its end, or a tactor was interrupted
///         and not driven again.
walk_result walk(const alsa_options& device, const environment& e, const render_options& render,
                 const walk_options& o, const session::stream_source& source = {});

} // namespace tactor::cli
