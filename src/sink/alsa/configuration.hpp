// SPDX-License-Identifier: MIT
/// \file
/// ALSA's configuration, from the system or from a text.
#pragma once

#include <memory>
#include <string>

#include <alsa/asoundlib.h>

#include "core/owned.hpp"

namespace tactor::alsa {

using configuration = std::unique_ptr<snd_config_t, detail::deleter<snd_config_delete>>;

/// Parses a configuration.
/// \throws error (bad_input) for text that ALSA cannot read.
configuration parse(const std::string& text);

/// ALSA's configuration as snd_pcm_open() finds it. It is not read again while this object lives. Without a
/// free descriptor it is not read at all: libasound would skip the files that it cannot open, and keep that
/// configuration until one of them changes.
class system_configuration {
public:
    system_configuration();
    ~system_configuration();
    system_configuration(const system_configuration&) = delete;
    system_configuration& operator=(const system_configuration&) = delete;

    /// Returns null if there is none, or if it was not read.
    snd_config_t* get() const noexcept { return top_; }
    /// Returns the same.
    /// \throws error (runtime) if it was not read.
    snd_config_t* read() const;
    /// Returns the negative errno because of which it was not read, else 0.
    int refused() const noexcept { return refused_; }

private:
    snd_config_t* top_ = nullptr;
    int refused_;
};

} // namespace tactor::alsa
