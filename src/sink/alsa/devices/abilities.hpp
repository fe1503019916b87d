// SPDX-License-Identifier: MIT
/// \file
/// What an open PCM can do, as values.
#pragma once

#include <string>

#include <alsa/asoundlib.h>

#include <tactor/devices.hpp>

#include "sink/alsa/handle.hpp"

namespace tactor::pcm {

/// All of a configuration space that open_alsa() would choose from. Configures nothing.
pcm_abilities abilities_of(snd_pcm_t* p, const hw_params& space);

} // namespace tactor::pcm
