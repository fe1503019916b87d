// SPDX-License-Identifier: MIT
/// \file
/// A PCM that is open already as a sink: for devices that live in the test itself.
#pragma once

#include <memory>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::pcm {

/// Configures and owns `p`, closed on failure too. Throws as open_alsa() does; `o.pcm` is but a name.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o);

} // namespace tactor::pcm
