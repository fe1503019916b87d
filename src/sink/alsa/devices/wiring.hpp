// SPDX-License-Identifier: MIT
/// \file
/// Map from the channels of a PCM to the channels of its device, from ALSA's configuration. Opens nothing.
#pragma once

#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

namespace tactor::pcm {

/// Finds the wiring of the first `channels` of a PCM that is opened with `device_channels`, without
/// conversion, as open() does.
stream_wiring find_wiring(snd_config_t* top, const std::string& name, unsigned channels,
                          unsigned device_channels);
/// Finds the wiring of the options' channels, in their configuration text or the system's configuration.
stream_wiring find_wiring(const alsa_options& o, unsigned device_channels);

} // namespace tactor::pcm
