// SPDX-License-Identifier: MIT
/// \file
/// What only `play` is asked for: latency, rights, lines, what to do when the stream breaks.
#pragma once

#include <optional>
#include <string>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct play_options {
    std::optional<double> latency_ms;
    std::optional<unsigned> period_frames;
    std::optional<unsigned> periods;
    bool require_realtime = false;
    bool void_on_xrun = false;
    double reopen_s = 0.0; ///< how long a lost device is waited for
    bool arm = false;
    bool live = false;                 ///< points come from standard input
    std::optional<double> smooth_s;    ///< of those
    std::optional<std::string> socket; ///< of a server to play through; here where none is named
    double sync_delay_ms = 50.0;
    bool no_gpio = false;
    bool verbose = false;
    std::string log; ///< file that lines are appended to; empty: none
    std::optional<double> power_dbfs;
    std::optional<double> max_drive_s;
    std::optional<double> drive_window_s;
    std::string format = "text";

    bool json() const { return format == "json"; }
};

void add_play_options(CLI::App& command, play_options& into);
/// Those of them that say how the array is driven: latency, rights, lines, limits.
void add_stream_options(CLI::App& command, play_options& into);
/// Those of these that tell what becomes of the stream; --log is one, or where it means something else, none.
void add_log_options(CLI::App& command, play_options& into);
void add_verbose_option(CLI::App& command, play_options& into);

/// Whether anything says which PCM to play on.
bool names_device(const settings& s, const environment& e);

/// The PCM as it is to be opened for so many channels at that rate, Hz; "null" where nothing names one.
/// \throws error (bad_input) where an array file says more than the name of a device.
alsa_options device_options(const settings& s, const play_options& p, const environment& e, unsigned channels,
                            unsigned rate);

/// What holds: the options, else [limits], else the defaults. \throws error for a drive time that is none.
drive_limits limits_of(const play_options& o, const environment& e);

/// Latency that is asked for, ms: the option's, else that of [defaults] where no option gives a period.
std::optional<double> asked_latency_ms(const play_options& o, const environment& e);

/// A sentence where the device makes more latency than was asked for; else empty.
std::string latency_warning(std::optional<double> asked_ms, const stream_setup& made);

/// Time that the buffer holds.
double latency_ms(const stream_setup& s);

} // namespace tactor::cli
