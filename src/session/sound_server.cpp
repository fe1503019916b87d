// SPDX-License-Identifier: MIT
#include "session/sound_server.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tactor/tactor.hpp>

#include "session/say.hpp"

namespace tactor::session {

std::string settle_server(const std::string& pcm)
{
    std::string server = read_route(pcm).server;
    // Channels have no places to PipeWire's ALSA plugin beyond those of loudspeakers: it would mix nine of
    // them down to what it takes the card for, as a rule to two.
    if (server == "PipeWire")
        ::setenv("PIPEWIRE_ALSA", "{ stream.dont-remix = true }", 0);
    return server;
}

bool is_felt(const std::string& pcm)
{
    const std::vector<std::string> types = read_route(pcm).types;
    const auto ends_in = [&types](const char* type) {
        return std::find(types.begin(), types.end(), type) != types.end();
    };
    return !ends_in("null") || ends_in("hw");
}

std::string server_note(const std::string& server)
{
    return fmt::format("{} is in between: it may mix, resample and hide xruns", server);
}

void warn_of_server(const std::string& server, const char* cure)
{
    if (!server.empty())
        say(stderr, "tactor: warning: {} ({})\n", server_note(server), cure);
}

std::vector<device_note> wiring_notes(const array& a, const stream_setup& s)
{
    std::vector<device_note> all;
    for (std::string& odd : wiring_warnings(a, s.wiring))
        all.push_back({std::move(odd),
                       "set the coefficient to 1 where the PCM is defined (ttable), or play on "
                       "the card itself, -D hw:CARD=NAME"});
    const std::string& between = s.wiring.hidden_by;
    if (!between.empty() && read_route(s.name).server.empty())
        all.push_back(
            {fmt::format("whether each tactor has a channel of the device to itself is not known: {} "
                         "is between",
                         between),
             server_cure});
    return all;
}

} // namespace tactor::session
