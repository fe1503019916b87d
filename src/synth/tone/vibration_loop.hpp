// SPDX-License-Identifier: MIT
/// \file
/// Samples of a vibration from a haptic file, with its emphases.
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/plan.hpp>

#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// Returns `frames` frames of a vibration at the rate of the stream. Without a course the vibration plays at
/// its own speed. A course gives the speed instead, in vibrations a second.
wave_samples vibration_loop(const vibration& v, const std::vector<carrier_point>& course, std::size_t frames,
                            unsigned rate);

} // namespace tactor::synth
