// SPDX-License-Identifier: MIT
/// \file
/// The sound cards and the processes that play on them, from the kernel's files. Also the list of PCMs. Tests
/// pass a folder with files like the kernel's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::alsa {

/// Folder that contains proc and dev: the root folder, or a folder of a test.
using system_root = std::filesystem::path;

/// Returns the cards in order of index. Empty without a sound driver.
std::vector<card_info> sound_cards(const system_root& root);

struct playback_device {
    unsigned number = 0;
    std::string name = {}; ///< as the driver names it; may be empty
};
std::vector<playback_device> playback_devices(const system_root& root, unsigned card_index);

/// Card and device to which an ALSA name refers, as in "hw:CARD=Tactor,DEV=1" or "plughw:0,1".
struct device_name {
    std::string card = {}; ///< id or index
    unsigned device = 0;
};
std::optional<device_name> parse_device_name(std::string_view pcm);

/// Returns the card with that id or index, if any.
std::optional<card_info> find_card(const std::vector<card_info>& cards, const std::string& id_or_index);

/// Selection of playback devices. If `device` is empty, it selects all devices of the card. If `card` is
/// empty, too, it selects all devices of all cards.
struct which_device {
    std::optional<unsigned> card = {};
    std::optional<unsigned> device = {};
};

/// Returns the processes that have a selected playback device open, in order of pid. Finds processes of other
/// users only if the sound driver reports them.
std::vector<process_info> playback_holders(const system_root& root, const which_device& wanted);

/// Returns the group whose members may open the playback devices; empty if it is not known.
std::string playback_group(const system_root& root);

/// Lists the PCMs as list_pcms() does, with the cards of `root`.
std::vector<pcm_info> list(const system_root& root, const std::optional<alsa_options>& wanted);

/// Fills in the abilities of an open PCM, and the reason why it does not fit `wanted`, if any.
void inspect_pcm(snd_pcm_t* p, const std::optional<alsa_options>& wanted, pcm_info& into);

} // namespace tactor::alsa
