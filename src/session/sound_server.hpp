// SPDX-License-Identifier: MIT
/// \file
/// Sound servers between the tool and the card, and where there is neither.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/sink.hpp>

namespace tactor::session {

/// The sound server that playing on a PCM goes through; empty: none. PipeWire is asked to give each channel
/// to the output of its number, not to mix: in the environment of this process, where nothing is said there
/// yet. Before there are threads, and before the PCM is opened.
std::string settle_server(const std::string& pcm);

/// Hint for a sound server in the way.
inline constexpr const char* server_cure =
    "-D hw:CARD=NAME plays on the card itself; tactor devices lists them";

/// Warns on standard error of the sound server in between; not where there is none.
void warn_of_server(const std::string& server, const char* cure = server_cure);

/// Whether anybody may feel what is played on a PCM: it does not end in one of type null alone.
bool is_felt(const std::string& pcm);

/// What a server in between may do.
std::string server_note(const std::string& server);

/// Something about a stream that is felt, or may be, and what to do about it.
struct device_note {
    std::string text;
    const char* cure;
};

/// Notes about the ways that the stream's channels go: levels that ALSA's configuration changes, and ways
/// that are not known (but not those through a server, of which server_note() tells).
std::vector<device_note> wiring_notes(const array& a, const stream_setup& s);

} // namespace tactor::session
