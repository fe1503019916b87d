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

namespace tactor::cli {

/// One STROKE argument and how it ended; no report: it was not played.
struct stroke_outcome {
    std::string name;
    std::uint64_t length_frames = 0;
    std::optional<stroke_report> report = {};
};

struct run_report {
    stream_setup device;
    std::vector<stroke_outcome> strokes;
    player_stats stats; ///< of all players of the run together
    unsigned reopened = 0;
    bool locked_memory = false;
};

/// Adds a further player's counters.
void add_stats(player_stats& sum, const player_stats& more);

/// "played 1.4 s", "interrupted after 0.2 s: reason".
std::string fate(const stroke_outcome& s, unsigned rate);

/// The same after "name: ".
std::string describe(const stroke_outcome& s, unsigned rate);

/// "hw:Tactor: 9 of 16 channels, 48000 Hz, s32, period 96 of 288 frames, latency 6.0 ms"
std::string describe(const stream_setup& d);

/// On standard error, where tactors were driven for too long.
void warn_of_cuts(const drive_limits& l, const player_stats& s);

/// What there is to say, before all else, of an amplifier that may be on.
std::optional<error> left_on(const player_stats& s);

/// What there is to say in the end of strokes that did not finish; nothing where all of them did.
std::optional<error> unfinished(const run_report& r);

/// A short table of the counters.
void print_table(std::FILE* to, const run_report& r);

/// One object of schema tactor-play/1.
void print_json(std::FILE* to, const run_report& r);

} // namespace tactor::cli
