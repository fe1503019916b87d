// SPDX-License-Identifier: MIT
/// \file
/// Hardware and software parameters of a PCM.
#pragma once

#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

#include "sink/alsa/handle.hpp"

namespace tactor::pcm {

/// \throws error (bad_input) for numbers that no PCM can have.
void check(const alsa_options& o);

/// The whole configuration space of the PCM with interleaved samples and without resampling; `name` is for
/// errors.
/// \throws error (not_available).
hw_params configuration_space(snd_pcm_t* p, const std::string& name);

/// Why the channels, rate and format asked for are not possible together; empty: they are.
std::string misfit(snd_pcm_t* p, const hw_params& space, const alsa_options& o);

/// Sets the channels and the rate asked for, the first format that fits, and the nearest period and buffer;
/// returns the set-up that the device has then.
/// \throws error (not_available) with the set asked for and what the device can do; of the field "channels"
///         where it has not that many.
stream_setup negotiate(snd_pcm_t* p, const alsa_options& o);

/// Explicit start, stop on the first missing frame, silence where nothing was written.
/// \throws error (not_available).
void set_software(snd_pcm_t* p, const stream_setup& s);

} // namespace tactor::pcm
