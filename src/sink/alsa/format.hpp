// SPDX-License-Identifier: MIT
/// \file
/// Sample formats as ALSA names them.
#pragma once

#include <array>

#include <alsa/asoundlib.h>

#include <tactor/choices.hpp>

namespace tactor::pcm {

/// Formats in the order in which they are tried: first those that I2S and USB devices carry without loss.
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

} // namespace tactor::pcm
