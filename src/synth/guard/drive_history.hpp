// SPDX-License-Identifier: MIT
/// \file
/// For how long each channel was driven lately: what outlives a mixer, so that a device that is opened again
/// does not give a tactor its time back.
#pragma once

#include <vector>

namespace tactor::synth {

/// A plain value, at any sample rate. Times are in seconds from the moment at which it was taken: before it
/// below 0.
struct drive_history {
    /// Driven for `driven_s` of the time from `begin_s` to `end_s`.
    struct stretch {
        double begin_s = 0.0;
        double end_s = 0.0;
        double driven_s = 0.0;
    };
    struct channel {
        std::vector<stretch> stretches = {}; ///< in order, not overlapping
        double opens_s = 0.0;                ///< until then it is cut
    };
    std::vector<channel> channels = {}; ///< none where there is no limit

    /// So much time went by in silence since.
    void pass(double seconds) noexcept
    {
        for (channel& c : channels) {
            c.opens_s -= seconds;
            for (stretch& s : c.stretches) {
                s.begin_s -= seconds;
                s.end_s -= seconds;
            }
        }
    }
};

} // namespace tactor::synth
