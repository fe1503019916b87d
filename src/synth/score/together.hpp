// SPDX-License-Identifier: MIT
/// \file
/// Strokes that sound together: the greatest sum of their envelopes on each tactor, and the weakening of a
/// score that exceeds the requested level.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Returns the first frame in which an item may be felt: a ramp begins with a zero, and so do most carriers.
/// Rounding may put the first frame into the end of another burst or stroke that it touches.
std::uint64_t heard_from(const score::impl& s, const item& it);

/// Greatest level of a tactor, and the first frame at which it reaches it.
struct tactor_peak {
    double level = 0.0; ///< linear
    std::uint64_t frame = 0;
};

/// Returns the peak of each tactor: the greatest sum of the envelopes that sound on it at one time. Carriers
/// of one frequency and phase reach it; beating carriers may. A sound alone counts with its amplitude. Visits
/// each event and, where ramps meet, each frame. Makes no samples.
/// \pre The items of the score are measured, by start.
std::vector<tactor_peak> find_peaks(const std::shared_ptr<const score::impl>& made);

/// Weakens a score by the factor that brings its loudest tactor to the requested level. Returns false if no
/// tactor exceeds the level.
/// \pre As find_peaks().
bool weaken_to_level(const std::shared_ptr<score::impl>& made);

/// Weakens a score by the factor that brings each tactor within its limit, by index. The peaks are those of
/// find_peaks().
void weaken_to_limits(score::impl& s, const std::vector<tactor_peak>& peaks,
                      const std::vector<double>& limits);

} // namespace tactor::synth
