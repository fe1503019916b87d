// SPDX-License-Identifier: MIT
/// \file
/// Which channels of the device the channels of a PCM reach, as ALSA's configuration says. Nothing is opened.
#pragma once

#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

namespace tactor::pcm {

/// The wiring of a PCM that is opened with so many channels, none of them converted, as open() does.
stream_wiring find_wiring(snd_config_t* top, const std::string& name, unsigned channels);
/// By the text of the options, or the system's configuration.
stream_wiring find_wiring(const alsa_options& o);

} // namespace tactor::pcm
