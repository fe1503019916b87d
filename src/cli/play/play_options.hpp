// SPDX-License-Identifier: MIT
/// \file
/// What only `play` is asked for: latency, rights, lines, what to do when the stream breaks.
#pragma once

#include <optional>
#include <string>

#include <tactor/tactor.hpp>

#include "session/device.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

/// The options of `play`.
struct play_options : session::stream_options {
    bool void_on_xrun = false;
    bool live = false;                      ///< points come from standard input
    std::optional<double> smooth_s = {};    ///< of those
    std::optional<std::string> socket = {}; ///< of a server to play through; here where none is named
    std::string format = "text";

    bool json() const { return format == "json"; }
};

void add_play_options(CLI::App& command, play_options& into);
/// Those of them that say how the array is driven: latency, rights, lines, limits.
void add_stream_options(CLI::App& command, session::stream_options& into);
/// Those of these that tell what becomes of the stream; --log is one, or where it means something else, none.
void add_log_options(CLI::App& command, session::stream_options& into);
void add_verbose_option(CLI::App& command, session::stream_options& into);

} // namespace tactor::cli
