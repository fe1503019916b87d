// SPDX-License-Identifier: MIT
/// \file
/// What the name of a PCM leads to, as ALSA's configuration defines it. Nothing is opened.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <alsa/asoundlib.h>

namespace tactor::pcm {

/// Calls `visit` for each member of a compound, with its name; for other nodes it calls nothing.
template <typename Visit>
void each_member(snd_config_t* compound, Visit visit)
{
    if (snd_config_get_type(compound) != SND_CONFIG_TYPE_COMPOUND)
        return;
    snd_config_iterator_t i = snd_config_iterator_first(compound);
    for (; i != snd_config_iterator_end(compound); i = snd_config_iterator_next(i)) {
        snd_config_t* member = snd_config_iterator_entry(i);
        const char* id = nullptr;
        if (snd_config_get_id(member, &id) == 0 && id != nullptr)
            visit(std::string(id), member);
    }
}

/// Most plugins on plugins that are followed: a definition may name itself.
inline constexpr int deepest = 8;

template <typename Names>
bool among(const Names& names, std::string_view type)
{
    return std::find(names.begin(), names.end(), type) != names.end();
}

/// Stands for the type of a definition that leads to itself, or farther than any real one does.
inline constexpr const char* endless = "?";

/// The types of the plugins that a PCM plays through, as their definitions name them: "plug", "hw". A PCM
/// that is not defined has none.
std::vector<std::string> find_route(snd_config_t* top, const std::string& name);
/// By the system's configuration.
std::vector<std::string> find_route(const std::string& name);

/// The first type that has other effects than sound: "file", which writes a file or starts a command, and any
/// unknown type. Empty: there is none.
std::string unsafe_type(const std::vector<std::string>& route);

/// The first type that starts something lasting when it is opened: a mixer starts its card, a client its
/// server. An unknown type counts, too. Empty: opening changes nothing.
std::string lasting_type(const std::vector<std::string>& route);

/// Whether opening the PCM empties a file or starts a command.
bool writes(const std::vector<std::string>& route);

/// "PipeWire", "PulseAudio" or "JACK", where the route ends in one; else empty.
std::string server_of(const std::vector<std::string>& route);

} // namespace tactor::pcm
