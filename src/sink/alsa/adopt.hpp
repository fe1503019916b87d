// SPDX-License-Identifier: MIT
/// \file
/// Sinks of PCMs that are already open, for devices that live in the test itself.
#pragma once

#include <memory>
#include <string_view>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>

namespace tactor::alsa {

/// Configures `p` and owns it; closes it on failure, too. Throws as open_alsa() does; `o.pcm` is only a name.
/// `as_card`: treats its clock as a card's, which never stops for this process. `device`: as
/// stream_setup::device.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card = false,
                            std::string_view device = {});

} // namespace tactor::alsa
