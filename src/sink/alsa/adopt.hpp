// SPDX-License-Identifier: MIT
/// \file
/// Makes a sink of a PCM that is open already: for devices that live in the test itself.
#pragma once

#include <memory>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::pcm {

/// Configures `p` and owns it; closes it on failure, too. Throws as open_alsa() does; `o.pcm` is only a name.
/// `as_card`: its clock is taken for a card's, which goes on whatever happens here.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card = false);

} // namespace tactor::pcm
