// SPDX-License-Identifier: MIT
/// \file
/// The limits that would act on a score.
#pragma once

#include <tactor/render.hpp>

namespace tactor::synth {

/// Limits that change the samples of a score on an array that has rested.
struct limits_met {
    bool power = false;
    bool time = false; ///< of a drive
};

/// Renders a score and returns which of its own limits act; none if the score has none.
limits_met find_limits_met(const score& s);

} // namespace tactor::synth
