// SPDX-License-Identifier: MIT
/// \file
/// The list of PCMs, on a system that may be made of files.
#pragma once

#include <alsa/asoundlib.h>

#include <tactor/devices.hpp>

#include "sink/alsa/devices/cards.hpp"

namespace tactor::pcm {

/// list_pcms(), whose cards are those of `root`.
std::vector<pcm_info> list(const system_root& root, const std::optional<alsa_options>& wanted);

std::vector<process_info> processes(const std::vector<holder>& holders);

/// Fills in what an open PCM can do and whether that fits.
void look_at(snd_pcm_t* p, const std::optional<alsa_options>& wanted, pcm_info& into);

} // namespace tactor::pcm
