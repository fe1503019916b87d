// SPDX-License-Identifier: MIT
/// \file
/// The walk: sounds, questions, answers, and the array file with the channels as they were felt.
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
    bool ask = true;    ///< else each is only named
    std::string output; ///< the file for the map; empty: none
};

struct walk_result {
    int signal = 0; ///< that ended it, or 0
    session::walk_answers felt;
};

/// Returns three bursts on one tactor.
piece walk_one(const array& a, unsigned tactor, double carrier_hz);

/// Drives each tactor and asks where it was felt, on standard input. Questions go to standard output, or to
/// standard error where that is JSON.
/// \throws error: what play throws; runtime when the walk is left before its end, and in the end where a
/// tactor was not driven to its end and not again.
walk_result walk(const alsa_options& device, const environment& e, const render_options& render,
                 const walk_options& o, const session::stream_source& source = {});

/// Whether a new file can be made there. \throws error (bad_input): there is one, or no such folder.
void check_new_file(const std::string& name);

/// Writes a new array file: the text of the one in use with other channels; where that is none, or its text
/// cannot be used from there, a file that takes the array from it. Nothing is left where it fails.
/// \throws error: bad_input as check_new_file() does, runtime when it cannot be written.
void write_channel_file(const std::string& name, const environment& e, const std::vector<unsigned>& channels);

} // namespace tactor::cli
