// SPDX-License-Identifier: MIT
/// \file
/// Whether the PCM opens as it would for playing.
#pragma once

#include "cli/check/finding.hpp"
#include "cli/settings.hpp"
#include "session/device.hpp"

namespace tactor::cli {

/// Opens and closes it, but for one that writes a file; nothing sounds. `named`: whether anything names it,
/// else it is the default.
finding check_device(const alsa_options& device, const session::stream_options& o, const environment& e,
                     bool named);

} // namespace tactor::cli
