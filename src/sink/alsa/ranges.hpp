// SPDX-License-Identifier: MIT
/// \file
/// What a device can do, for people.
#pragma once

#include <string>

#include "sink/alsa/handle.hpp"

namespace tactor::pcm {

/// "channels 1 to 8, rates 44100 to 192000 Hz, formats s32 s16" of a configuration space.
std::string describe(const hw_params& p);

} // namespace tactor::pcm
