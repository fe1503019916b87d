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

/// Reads a configuration: the text, or without one the system's files, as they are now. libasound's own copy
/// of these belongs to the host program, and keeps what ~/.asoundrc was when it was first read.
/// \throws error: bad_input for text that ALSA cannot read; not_available for files that it cannot read, with
///         file and line; runtime without a free descriptor: libasound would skip the files that it cannot
///         open.
configuration read_configuration(const std::string& text = {});

} // namespace tactor::alsa
