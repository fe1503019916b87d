// SPDX-License-Identifier: MIT
/// \file
/// ALSA's configuration: the system's, or a text's.
#pragma once

#include <memory>
#include <string>

#include <alsa/asoundlib.h>

#include "core/owned.hpp"

namespace tactor::pcm {

using configuration = std::unique_ptr<snd_config_t, detail::deleter<snd_config_delete>>;

/// \throws error (bad_input) for what ALSA cannot read.
configuration parse(const std::string& text);

/// ALSA's configuration as snd_pcm_open() finds it; it is not reread while this object lives. Without a free
/// descriptor it is not read at all: libasound would leave out the files that it cannot open, and keep this
/// configuration until one of them changes.
class system_configuration {
public:
    system_configuration();
    ~system_configuration();
    system_configuration(const system_configuration&) = delete;
    system_configuration& operator=(const system_configuration&) = delete;

    /// Null where there is none, or where it was not read.
    snd_config_t* get() const noexcept { return top_; }
    /// The same. \throws error (runtime) where it was not read: that is no answer.
    snd_config_t* read() const;
    /// The negative errno for which it was not read; else 0.
    int refused() const noexcept { return refused_; }

private:
    snd_config_t* top_ = nullptr;
    int refused_;
};

} // namespace tactor::pcm
