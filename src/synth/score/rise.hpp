// SPDX-License-Identifier: MIT
/// \file
/// Actuators that need time to start: the boost that they get at the beginning of a burst.
#pragma once

#include <vector>

#include <tactor/array.hpp>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Strength that an actuator reaches in a burst, by the model of a first-order lag (1 - e^(-t / rise_s) of a
/// steady vibration after t).
class lag {
public:
    /// Prepares for bursts that rise in `attack` frames and fall in `release`; `rise` in frames, above 0.
    lag(double rise, std::uint32_t attack, std::uint32_t release, envelope_kind shape);

    /// Returns the part of a strength that is left after so many frames.
    double left(double frames) const noexcept;
    /// Returns the strength reached `frames` after the burst's begin, if strength 1 is asked for; not for
    /// times before the end of its attack.
    double risen(double frames) const noexcept;
    /// Returns the same at the end of a burst of so many frames, after its release.
    double fallen(double frames) const noexcept;

private:
    double rise_;
    double attack_;
    double release_;
    double after_attack_;
    double of_release_; ///< what the release itself adds
};

/// Lets the actuators of tactors with a rise_s reach a burst's strength as soon as the tactor's limit allows:
/// adds a second burst over the first half cycles of the carrier. Only for bursts that sound on their tactor
/// alone. `peaks`: greatest level of each tactor before, linear; the rest up to its limit may be used.
/// Returns whether there are new items, which stand at the end.
bool boost_rises(score::impl& s, const array& a, const std::vector<double>& peaks);

} // namespace tactor::synth
