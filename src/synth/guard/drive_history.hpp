// SPDX-License-Identifier: MIT
/// \file
/// For how long each channel was driven lately. It outlives a mixer: when a device is opened again, a tactor
/// does not get the time back that it has used up.
#pragma once

#include <cstddef>
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

        /// Whether it is not known to have been driven.
        bool empty() const noexcept { return stretches.empty() && opens_s <= 0.0; }
    };
    std::vector<channel> channels = {}; ///< none where there is no limit

    /// So much time has gone by since. Drives that were to come in this time count as driven; the rest was
    /// silence.
    void pass(double seconds) noexcept;
    /// Drops the drives that are still to come.
    void end_now() noexcept;
    /// Adds drives that are still to come: the first n channels are driven from now on for so long.
    void add_ahead(std::size_t n, double seconds);
    /// Whether all channels are empty.
    bool empty() const noexcept;
};

/// The history of an array that two players have driven, from the histories of both at the same moment. In no
/// stretch of time does a channel count as driven for longer than the stretch lasts.
drive_history together(const drive_history& a, const drive_history& b);

/// Drops the stretches that ended longer ago than `older_s`.
void forget(drive_history& h, double older_s);

/// Leaves at most so many stretches for each channel: the oldest are joined, so that they leave the window
/// later, never sooner. `most` is 1 at least.
void coarsen(drive_history& h, std::size_t most);

} // namespace tactor::synth
