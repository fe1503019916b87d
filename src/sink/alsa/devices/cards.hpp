// SPDX-License-Identifier: MIT
/// \file
/// The sound cards that there are and who plays on them, as the kernel tells in files, and the list of PCMs;
/// tests give it a system that is made of files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::pcm {

/// Where /proc and /dev are looked for; another folder in tests.
using system_root = std::filesystem::path;

struct card {
    unsigned index = 0;
    std::string id = {};   ///< as in hw:CARD=ID
    std::string name = {}; ///< for people
};

/// By index; none where there is no sound driver.
std::vector<card> sound_cards(const system_root& root);

/// Numbers of a card's playback devices.
std::vector<unsigned> playback_devices(const system_root& root, unsigned card_index);

/// What the driver calls a playback device; empty where it says nothing.
std::string playback_device_name(const system_root& root, unsigned card_index, unsigned device);

/// The card and the device that an ALSA name refers to, as in "hw:CARD=Tactor,DEV=1" or "plughw:0,1".
struct device_name {
    std::string card = {}; ///< id or index
    unsigned device = 0;
};
std::optional<device_name> named_device(std::string_view pcm);

/// The card of that id or index, if there is one.
std::optional<card> find_card(const std::vector<card>& cards, const std::string& id_or_index);

struct holder {
    int pid = 0;
    std::string program = {};
};

/// One playback device of a card; without `device` any of the card, without both any of any card.
struct which_device {
    std::optional<unsigned> card = {};
    std::optional<unsigned> device = {};
};

/// Processes that have such a playback device open, in order of pid. Of other users' processes only those are
/// seen that the sound driver tells of.
std::vector<holder> playback_holders(const system_root& root, const which_device& wanted);

/// The group whose members may open the playback devices; empty where that cannot be told.
std::string playback_group(const system_root& root);

/// Lists the PCMs as list_pcms() does, with the cards of `root`.
std::vector<pcm_info> list(const system_root& root, const std::optional<alsa_options>& wanted);

/// Returns the processes that hold a device, as values of the interface.
std::vector<process_info> processes(const std::vector<holder>& holders);

/// Fills in the abilities of an open PCM, and whether they fit.
void look_at(snd_pcm_t* p, const std::optional<alsa_options>& wanted, pcm_info& into);

} // namespace tactor::pcm
