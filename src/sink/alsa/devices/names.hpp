// SPDX-License-Identifier: MIT
/// \file
/// The names of PCMs that ALSA's configuration knows.
#pragma once

#include <string>
#include <vector>

#include <alsa/asoundlib.h>

namespace tactor::pcm {

struct known_name {
    std::string name = {};
    std::string description = {}; ///< one line; may be empty
};

/// Every PCM for playback that the configuration names and that needs no argument: those with a hint as
/// ALSA lists them, then the others.
std::vector<known_name> known_names();

/// All PCMs that a configuration defines under `pcm`, those that need arguments too; as hints for a mistyped
/// name.
std::vector<std::string> defined_pcms(snd_config_t* top);

} // namespace tactor::pcm
