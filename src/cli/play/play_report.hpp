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

#include <nlohmann/json_fwd.hpp>
#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

struct play_options {
    std::optional<std::string> socket = {}; ///< socket of a server; none: plays here
    std::string format = "text";

    bool json() const { return format == "json"; }
};

/// A STROKE argument and its report; no report: it was not played.
struct stroke_outcome {
    std::string name;
    std::uint64_t length_frames = 0;
    std::optional<stroke_report> report = {};
};

struct play_report : session::run_facts {
    std::vector<stroke_outcome> strokes = {};
};

/// Returns "played 1.4 s", "interrupted after 0.2 s: reason".
std::string fate(const stroke_outcome& s, unsigned rate);

/// Returns the same after "name: ".
std::string describe(const stroke_outcome& s, unsigned rate);

/// Returns "hw:Tactor: 9 of 16 channels, 48000 Hz, s32, period 96 of 288 frames, latency 6.0 ms"
std::string describe(const stream_setup& d);

/// Returns the final error about strokes that did not finish, if any.
std::optional<error> unfinished(const play_report& r);

/// Prints the end of a stroke on standard output, unless that is JSON.
void tell(const stroke_outcome& s, unsigned rate, bool as_json);

/// Function that plays strokes on a session and fills in their reports. Returns the error that broke the run
/// off, if any.
using playing = std::function<std::optional<error>(session::play_session&, std::vector<stroke_outcome>&)>;

/// Opens the device for so many channels at that rate, Hz, plays, ends, and prints the report. Returns the
/// exit status. \throws error: first of all if the amplifier may be on.
int hold_run(const settings& s, const environment& e, unsigned channels, unsigned rate, bool as_json,
             std::vector<stroke_outcome> strokes, const playing& play);

/// Returns the exit status of a run. `signal`: ended it; 0: none did. \throws error for a run that was broken
/// off or has strokes that did not finish.
int judge_run(const play_report& r, int signal, const std::optional<error>& broken);

/// Prints an object of schema tactor-play/1.
void print_json(std::FILE* to, const play_report& r);
/// Returns the schema of such an object.
nlohmann::ordered_json play_schema();

/// Plays all STROKEs through a server, one after the other; the exit status. \throws error, also for options
/// that are the server's owner's alone.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
