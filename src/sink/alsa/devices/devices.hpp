// SPDX-License-Identifier: MIT
/// \file
/// The list of PCMs; tests give it a system that is made of files.
#pragma once

#include <alsa/asoundlib.h>

#include <tactor/devices.hpp>

#include "sink/alsa/devices/cards.hpp"

namespace tactor::pcm {

/// As list_pcms(), with the cards of `root`.
std::vector<pcm_info> list(const system_root& root, const std::optional<alsa_options>& wanted);

std::vector<process_info> processes(const std::vector<holder>& holders);

/// Fills in the abilities of an open PCM, and whether they fit.
void look_at(snd_pcm_t* p, const std::optional<alsa_options>& wanted, pcm_info& into);

} // namespace tactor::pcm
