// SPDX-License-Identifier: MIT
/// \file
/// Sample formats in ALSA's terms.
#pragma once

#include <array>

#include <alsa/asoundlib.h>

#include <tactor/sample_format.hpp>

namespace tactor::pcm {

/// In the order in which they are tried: what I2S and USB devices carry without loss first.
inline constexpr std::array format_preference{sample_format::s32, sample_format::float32,
                                              sample_format::s24_3, sample_format::s24_4, sample_format::s16};

constexpr snd_pcm_format_t to_alsa(sample_format f) noexcept
{
    switch (f) {
    case sample_format::float32:
        return SND_PCM_FORMAT_FLOAT_LE;
    case sample_format::s16:
        return SND_PCM_FORMAT_S16_LE;
    case sample_format::s24_3:
        return SND_PCM_FORMAT_S24_3LE;
    case sample_format::s24_4:
        return SND_PCM_FORMAT_S24_LE;
    case sample_format::s32:
        return SND_PCM_FORMAT_S32_LE;
    }
    return SND_PCM_FORMAT_UNKNOWN;
}

} // namespace tactor::pcm
