// SPDX-License-Identifier: MIT
/// \file
/// Options of `play`, and the report of a run, for people and for programs.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

struct play_options {
    std::optional<std::string> socket = {}; ///< of a server to play through; here where none is named
    std::string format = "text";

    bool json() const { return format == "json"; }
};

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

/// Says how a stroke ended, on standard output unless that is JSON.
void tell(const stroke_outcome& s, unsigned rate, bool as_json);

/// Plays strokes on a session, and puts down what becomes of them. Returns what broke the run off, if
/// anything did.
using playing = std::function<std::optional<error>(session::play_session&, std::vector<stroke_outcome>&)>;

/// Opens the device for so many channels at that rate, Hz, plays, ends, and says how that went. Returns the
/// exit status. \throws error: first of all where the amplifier may be on.
int hold_run(const settings& s, const environment& e, unsigned channels, unsigned rate, bool as_json,
             std::vector<stroke_outcome> strokes, const playing& play);

/// Returns the exit status of a run that a signal has ended, 0: none has. \throws error for one that was
/// broken off or has strokes that did not finish.
int judge_run(const run_report& r, int signal, const std::optional<error>& broken);

/// One object of schema tactor-play/1.
void print_json(std::FILE* to, const run_report& r);

/// Plays all STROKEs through a server, one after the other; the exit status. \throws error, also for options
/// that are the server's owner's alone.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
