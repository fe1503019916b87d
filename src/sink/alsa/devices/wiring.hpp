// SPDX-License-Identifier: MIT
/// \file
/// Which channels of the device the channels of a PCM reach, as ALSA's configuration says. Nothing is opened.
#pragma once

#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

namespace tactor::pcm {

/// Finds the wiring of the first `channels` of a PCM that is opened with `device_channels`, none of them
/// converted, as open() does.
stream_wiring find_wiring(snd_config_t* top, const std::string& name, unsigned channels,
                          unsigned device_channels);
/// Finds the wiring of the options' channels, by their text or the system's configuration.
stream_wiring find_wiring(const alsa_options& o, unsigned device_channels);

} // namespace tactor::pcm
