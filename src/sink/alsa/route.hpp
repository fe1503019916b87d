// SPDX-License-Identifier: MIT
/// \file
/// Plugins between the name of a PCM and its device, from ALSA's configuration. Opens nothing.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

namespace tactor::alsa {

/// Calls `visit` for each member of a compound, with its name. Does nothing for null and for other types of
/// node.
template <typename Visit>
void for_each_member(snd_config_t* compound, Visit visit)
{
    if (compound == nullptr || snd_config_get_type(compound) != SND_CONFIG_TYPE_COMPOUND)
        return;
    snd_config_iterator_t i = snd_config_iterator_first(compound);
    for (; i != snd_config_iterator_end(compound); i = snd_config_iterator_next(i)) {
        snd_config_t* member = snd_config_iterator_entry(i);
        const char* id = nullptr;
        if (snd_config_get_id(member, &id) == 0 && id != nullptr)
            visit(std::string(id), member);
    }
}

template <typename Names>
bool contains(const Names& names, std::string_view type)
{
    return std::find(names.begin(), names.end(), type) != names.end();
}

/// Type that stands for a definition that refers to itself, or that is nested too deeply.
inline constexpr const char* endless = "?";

/// Returns the types of the plugins through which a PCM plays, as their definitions name them: "plug", "hw".
/// Empty for a PCM that is not defined.
std::vector<std::string> find_route(snd_config_t* top, const std::string& name);
/// Returns the types for the system's configuration; empty if ALSA cannot read it.
/// \throws error (runtime) if no descriptor is free.
std::vector<std::string> find_route(const std::string& name);

/// Returns why opening this PCM would make libasound 1.2 end the process, by a failed assertion or an index
/// beyond a table. Empty if no reason is known. Looks at all definitions on the route.
std::string find_fault(snd_config_t* top, const std::string& name);

/// Returns the first type with effects other than sound: "file", which writes a file or starts a command, or
/// any unknown type. Empty if there is none.
std::string unsafe_type(const std::vector<std::string>& route);

/// Returns the first type of plugin whose opening has a lasting effect, such as starting a card or a server.
/// Treats unknown types as having one. Empty if there is no such type.
std::string lasting_type(const std::vector<std::string>& route);

/// Returns true if opening the PCM empties a file or starts a command.
bool writes(const std::vector<std::string>& route);

/// Returns "PipeWire", "PulseAudio" or "JACK" if the route ends in one, else empty.
std::string find_server(const std::vector<std::string>& route);

/// Place of a PCM on a sound card of the kernel.
struct card_place {
    std::string card = {}; ///< id of the card
    unsigned device = 0;
    unsigned subdevice = 0;
};

/// Returns stream_setup::device of a PCM. All names that lead to the same place on a card have the same
/// value; the value of any other PCM is its name. Empty if the route ends in the null device, which nobody
/// feels. `place`: place of the PCM's device, or of the first of several devices, which `w` lists; empty if
/// it is not on a card.
std::string find_drive_time_device(const std::string& pcm, const std::vector<std::string>& route,
                                   const std::optional<card_place>& place, const stream_wiring& w);

struct known_name {
    std::string name = {};
    std::string description = {}; ///< one line; may be empty
};

/// Returns the PCMs for playback that the configuration names and that need no argument: those with a hint in
/// the order of ALSA, then the others. Empty without a configuration.
std::vector<known_name> known_names(snd_config_t* top);

/// Returns all PCMs that a configuration defines under `pcm`, including those that need arguments, as hints
/// for a mistyped name.
std::vector<std::string> defined_pcms(snd_config_t* top);

/// Finds the wiring of the first `channels` channels of a PCM that open() opens with `device_channels`
/// channels, without conversion.
stream_wiring find_wiring(snd_config_t* top, const std::string& name, unsigned channels,
                          unsigned device_channels);

} // namespace tactor::alsa
