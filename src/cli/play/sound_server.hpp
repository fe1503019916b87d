// SPDX-License-Identifier: MIT
/// \file
/// Sound servers between the tool and the card, and where there is neither.
#pragma once

#include <string>

#include <tactor/sink.hpp>

namespace tactor::cli {

/// The sound server that playing on a PCM goes through; empty: none. PipeWire is asked to give each channel
/// to the output of its number, not to mix: in the environment of this process, where nothing is said there
/// yet. Before there are threads, and before the PCM is opened.
std::string settle_server(const std::string& pcm);

/// Whether anybody may feel what is played on a PCM: it does not end in one of type null alone.
bool is_felt(const std::string& pcm);

/// What a server in between may do.
std::string server_note(const std::string& server);

/// What is not known of the ways that the stream's channels go; empty: all is, or a server is between, of
/// which server_note() tells.
std::string wiring_note(const stream_setup& s);

/// What to do about it.
inline constexpr const char* server_cure =
    "-D hw:CARD=NAME plays on the card itself; tactor devices lists them";

} // namespace tactor::cli
