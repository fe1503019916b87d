// SPDX-License-Identifier: MIT
/// \file
/// Owners of ALSA's objects, its configuration, opening a PCM by name, and its parameters.
#pragma once

#include <array>
#include <memory>
#include <new>
#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/choices.hpp>

#include "core/owned.hpp"
#include "sink/alsa/error_text.hpp"

namespace tactor::alsa {

using detail::deleter;

using configuration = std::unique_ptr<snd_config_t, deleter<snd_config_delete>>;

/// Reads a configuration from `text`, or from the system's files as they are now if `text` is empty. Does not
/// use libasound's copy of the files: it belongs to the host program, and keeps what ~/.asoundrc contained
/// when it was first read.
/// \throws error: bad_input for text that ALSA cannot read; not_available for files that it cannot read, with
///         file and line; runtime if no descriptor is free, because libasound would skip files that it cannot
///         open.
configuration read_configuration(const std::string& text = {});

inline constexpr unsigned most_channels = max_pcm_channels;

/// Deleter that closes a PCM and keeps a plugin's messages off standard error.
struct closer {
    void operator()(snd_pcm_t* p) const noexcept
    {
        const quiet silent;
        snd_pcm_close(p);
    }
};

using handle = std::unique_ptr<snd_pcm_t, closer>;
using hw_params = std::unique_ptr<snd_pcm_hw_params_t, deleter<snd_pcm_hw_params_free>>;
using sw_params = std::unique_ptr<snd_pcm_sw_params_t, deleter<snd_pcm_sw_params_free>>;
using status = std::unique_ptr<snd_pcm_status_t, deleter<snd_pcm_status_free>>;

/// Allocates an ALSA object. `make`: ALSA's function that allocates it.
/// \throws std::bad_alloc.
template <typename Owner>
Owner allocate(int (*make)(typename Owner::pointer*))
{
    typename Owner::pointer p = nullptr;
    if (make(&p) < 0)
        throw std::bad_alloc();
    return Owner(p);
}

/// Opens a PCM of this configuration for playback: non-blocking, without hidden conversion.
/// \throws error as open_alsa() does.
handle open(const alsa_options& o, snd_config_t* top);

/// Checks the options.
/// \throws error (bad_input) for numbers that no PCM can have.
void check(const alsa_options& o);

/// Returns the whole configuration space of the PCM, without resampling, for interleaved samples, or for
/// planar samples if the PCM takes no others. `name` is for errors.
/// \throws error (not_available).
hw_params configuration_space(snd_pcm_t* p, const std::string& name);

/// Returns why the requested channels, rate and format are not possible together; empty if they are.
std::string misfit(snd_pcm_t* p, const hw_params& space, const alsa_options& o);

/// Sets the requested channels and rate, the first format that fits, and the nearest period and buffer.
/// Returns the set-up of the device.
/// \throws error (not_available) with the request and what the device can do. The error has the field
///         "channels" if the device does not have the requested number.
stream_setup negotiate(snd_pcm_t* p, const alsa_options& o);

/// Sets an explicit start, a stop on the first missing frame, and silence where nothing was written.
/// \throws error (not_available).
void set_software_params(snd_pcm_t* p, const stream_setup& s);

/// Formats in the order in which open_alsa() tries them: first those that I2S and USB devices carry without
/// loss.
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
