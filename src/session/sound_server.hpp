// SPDX-License-Identifier: MIT
/// \file
/// Sound servers between the tool and the card, and PCMs without a card.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/sink.hpp>

namespace tactor::session {

/// Returns the sound server between this process and a PCM; empty: none. Sets PipeWire's variable of this
/// process, if it is unset, so that each channel goes to the output of its number without mixing. Call it
/// before there are threads and before the PCM is opened.
std::string settle_server(const std::string& pcm);

/// Hint for a sound server in the way.
inline constexpr const char* server_cure =
    "-D hw:CARD=NAME plays on the card itself; tactor devices lists them";

/// Warns on standard error of the sound server in between, if there is one.
void warn_of_server(const std::string& server, const char* cure = server_cure);

/// Returns true if anybody may feel a PCM: it does not end in PCMs of type null alone.
bool is_felt(const std::string& pcm);

/// Returns the effects that a server in between may have.
std::string server_note(const std::string& server);

/// A remark about a stream that is or may be felt, and a hint.
struct device_note {
    std::string text;
    const char* cure;
};

/// Lists notes about the routes of the stream's channels: levels that ALSA's configuration changes, and
/// unknown routes (except those through a server: server_note()).
std::vector<device_note> wiring_notes(const array& a, const stream_setup& s);

} // namespace tactor::session
