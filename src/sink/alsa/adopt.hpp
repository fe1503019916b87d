// SPDX-License-Identifier: MIT
/// \file
/// A PCM that is open already as a sink: for devices that live in the test itself.
#pragma once

#include <memory>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::pcm {

/// Configures and owns `p`, closed on failure too. Throws as open_alsa() does; `o.pcm` is but a name.
/// `as_card`: its clock is taken for a card's, which goes on whatever happens here.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card = false);

} // namespace tactor::pcm
