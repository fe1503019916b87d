// SPDX-License-Identifier: MIT
/// \file
/// What came of a run, for people and for programs.
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/play/play_options.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

/// One STROKE argument and how it ended; no report: it was not played.
struct stroke_outcome {
    std::string name;
    std::uint64_t length_frames = 0;
    std::optional<stroke_report> report = {};
};

struct run_report : session::run_facts {
    std::vector<stroke_outcome> strokes = {};
};

/// "played 1.4 s", "interrupted after 0.2 s: reason".
std::string fate(const stroke_outcome& s, unsigned rate);

/// The same after "name: ".
std::string describe(const stroke_outcome& s, unsigned rate);

/// "hw:Tactor: 9 of 16 channels, 48000 Hz, s32, period 96 of 288 frames, latency 6.0 ms"
std::string describe(const stream_setup& d);

/// What there is to say in the end of strokes that did not finish; nothing where all of them did.
std::optional<error> unfinished(const run_report& r);

/// Says how a run went that is finished. Returns the exit status where a signal ended it. \throws error where
/// an amplifier may be on, before all else.
std::optional<int> tell_end(const session::play_session& session, bool as_json, const session::environment& e,
                            const run_report& r);

/// A short table of the counters.
void print_table(std::FILE* to, const run_report& r);

/// One object of schema tactor-play/1.
void print_json(std::FILE* to, const run_report& r);

} // namespace tactor::cli
