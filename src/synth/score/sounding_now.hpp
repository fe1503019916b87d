// SPDX-License-Identifier: MIT
/// \file
/// Drive of each tactor at one time, for pictures of what plays.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/render.hpp>

#include "synth/score/event_source.hpp"

namespace tactor::synth {

/// Levels of the tactors along a score. Keeps only the drives that sound. Control side, one thread at a time.
class sounding_now {
public:
    explicit sounding_now(const score& s);

    /// Returns the amplitude of each tactor in a frame of the score, by index; 1 is the requested intensity.
    /// Frames do not go back: an earlier frame than the last one counts as the last one. Valid until the next
    /// call.
    const std::vector<double>& at(std::uint64_t frame);

private:
    score score_;
    event_source source_;
    std::uint64_t latest_ = 0;
    std::vector<drive_event> open_; ///< begun and not over
    std::vector<double> energy_;    ///< by channel, at full level
    std::vector<double> levels_;
};

} // namespace tactor::synth
