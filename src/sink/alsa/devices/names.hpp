// SPDX-License-Identifier: MIT
/// \file
/// Names of the PCMs in ALSA's configuration.
#pragma once

#include <string>
#include <vector>

#include <alsa/asoundlib.h>

namespace tactor::pcm {

struct known_name {
    std::string name = {};
    std::string description = {}; ///< one line; may be empty
};

/// Returns every PCM for playback that the configuration names and that needs no argument: first those with a
/// hint, as ALSA lists them, then the others.
std::vector<known_name> known_names();

/// Returns all PCMs that a configuration defines under `pcm`, also those that need arguments. For hints about
/// a mistyped name.
std::vector<std::string> defined_pcms(snd_config_t* top);

} // namespace tactor::pcm
