// SPDX-License-Identifier: MIT
/// \file
/// What drivers of the kernel say, and no plugin can be made to: stands before libasound's functions in this
/// program.
#pragma once

#include <optional>

#include <alsa/asoundlib.h>

namespace tactor::test {

struct device_answers {
    int card = -1;
    bool batch = false;
    bool takes_periods = true; ///< their number can be set
    std::optional<unsigned> channels = {};
    std::optional<unsigned> rate = {};
    std::optional<snd_pcm_uframes_t> period_frames = {};
    std::optional<snd_pcm_uframes_t> buffer_frames = {};
};

/// As long as it lives every PCM says this; else what it says itself.
class device_says {
public:
    explicit device_says(const device_answers& a);
    ~device_says();
    device_says(const device_says&) = delete;
    device_says& operator=(const device_says&) = delete;
};

} // namespace tactor::test
