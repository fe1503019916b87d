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

/// Returns the first frame in which an item may be felt: its second frame if the ramp or the carrier begins
/// at zero. Rounding may put the first frame into the end of a burst or stroke that the item follows at once.
std::uint64_t first_felt_frame(const score::impl& s, const item& it);

/// Greatest level of a tactor, and the first frame with this level.
struct tactor_peak {
    double level = 0.0; ///< linear
    std::uint64_t frame = 0;
};

/// Returns the peak of each tactor: the greatest sum of the envelopes that sound on it at one time. Carriers
/// of the same frequency and phase reach this sum; carriers that beat may reach it. A burst that sounds alone
/// counts with its amplitude. Visits each event, and the frames of ramps that overlap. Makes no samples.
/// \pre end_items() has put the items of the score in order.
std::vector<tactor_peak> find_peaks(const std::shared_ptr<const score::impl>& made);

/// Weakens a score by the factor that brings its loudest tactor to the requested level. Returns false if no
/// tactor exceeds the level.
/// \pre end_items() has put the items of the score in order.
bool weaken_to_level(const std::shared_ptr<score::impl>& made);

/// Weakens a score by the factor that brings all tactors within their limits. `peaks`: result of
/// find_peaks(). `limits`: by tactor, linear.
void weaken_to_limits(score::impl& s, const std::vector<tactor_peak>& peaks,
                      const std::vector<double>& limits);

} // namespace tactor::synth
