// SPDX-License-Identifier: MIT
/// \file
/// Answers of kernel drivers that no plugin can give: replaces libasound's functions in this program.
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

/// Makes every PCM answer this as long as it lives.
class device_says {
public:
    explicit device_says(const device_answers& a);
    ~device_says();
    device_says(const device_says&) = delete;
    device_says& operator=(const device_says&) = delete;
};

} // namespace tactor::test
