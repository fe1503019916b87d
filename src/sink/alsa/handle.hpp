// SPDX-License-Identifier: MIT
/// \file
/// Owners of ALSA's objects, its configuration, and opening a PCM by name.
#pragma once

#include <memory>
#include <string>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

#include "core/owned.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {

using configuration = std::unique_ptr<snd_config_t, detail::deleter<snd_config_delete>>;

/// Reads a configuration: the text, or without one the system's files, as they are now. libasound's own copy
/// of these belongs to the host program, and keeps what ~/.asoundrc was when it was first read.
/// \throws error: bad_input for text that ALSA cannot read; not_available for files that it cannot read, with
///         file and line; runtime without a free descriptor: libasound would skip the files that it cannot
///         open.
configuration read_configuration(const std::string& text = {});

inline constexpr unsigned most_channels = max_pcm_channels;

using detail::deleter;

/// Closes a PCM and keeps a plugin's messages off standard error.
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

hw_params make_hw_params();
hw_params copy(const hw_params& p);
sw_params make_sw_params();
status make_status();

/// Opens a PCM of this configuration for playback: non-blocking, without hidden conversion.
/// \throws error as open_alsa() does.
handle open(const alsa_options& o, snd_config_t* top);

} // namespace tactor::alsa
