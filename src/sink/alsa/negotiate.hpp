// SPDX-License-Identifier: MIT
/// \file
/// Hardware and software parameters of a PCM.
#pragma once

#include <array>
#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/choices.hpp>

#include "sink/alsa/handle.hpp"

namespace tactor::alsa {

/// Checks the options.
/// \throws error (bad_input) for numbers that no PCM can have.
void check(const alsa_options& o);

/// Returns the whole configuration space of the PCM with interleaved samples and without resampling. `name`
/// is for errors.
/// \throws error (not_available).
hw_params configuration_space(snd_pcm_t* p, const std::string& name);

/// Returns why the requested channels, rate and format are not possible together; empty if they are.
std::string misfit(snd_pcm_t* p, const hw_params& space, const alsa_options& o);

/// Sets the requested channels and rate, the first format that fits, and the nearest period and buffer.
/// Returns the set-up of the device.
/// \throws error (not_available) with the request and what the device can do. It has the field "channels" if
///         the device does not have as many.
stream_setup negotiate(snd_pcm_t* p, const alsa_options& o);

/// Sets an explicit start, a stop on the first missing frame, and silence where nothing was written.
/// \throws error (not_available).
void set_software(snd_pcm_t* p, const stream_setup& s);

/// In the order in which they are tried: first those that I2S and USB devices carry without loss.
inline constexpr std::array format_preference{format_kind::s32, format_kind::float32, format_kind::s24_3,
                                              format_kind::s24_4, format_kind::s16};

constexpr snd_pcm_format_t to_alsa(format_kind f) noexcept
{
    switch (f) {
    case format_kind::float32:
        return SND_PCM_FORMAT_FLOAT_LE;
    case format_kind::s16:
        return SND_PCM_FORMAT_S16_LE;
    case format_kind::s24_3:
        return SND_PCM_FORMAT_S24_3LE;
    case format_kind::s24_4:
        return SND_PCM_FORMAT_S24_LE;
    case format_kind::s32:
        return SND_PCM_FORMAT_S32_LE;
    }
    return SND_PCM_FORMAT_UNKNOWN;
}

} // namespace tactor::alsa
