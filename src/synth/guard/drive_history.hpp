// SPDX-License-Identifier: MIT
/// \file
/// Drive times of each channel in the recent past. They outlive a mixer: when a device is opened again, a
/// tactor does not get its used time back.
#pragma once

#include <cstddef>
#include <vector>

namespace tactor::synth {

/// Drive times, at any sample rate. A plain value. Times are in seconds from the moment when it was taken;
/// earlier ones are below 0.
struct drive_history {
    /// Drive for `driven_s` of the time from `begin_s` to `end_s`.
    struct stretch {
        double begin_s = 0.0;
        double end_s = 0.0;
        double driven_s = 0.0;
    };
    struct channel {
        std::vector<stretch> stretches = {}; ///< in order, not overlapping
        double opens_s = 0.0;                ///< time until which it is cut

        /// Returns true if it is not known to have been driven.
        bool empty() const noexcept { return stretches.empty() && opens_s <= 0.0; }
    };
    std::vector<channel> channels = {}; ///< empty without a limit

    /// Moves the history `seconds` into the past. Drives ahead that fall into this time count as driven; the
    /// rest was silence.
    void pass(double seconds) noexcept;
    /// Drops the drives that are still ahead.
    void end_now() noexcept;
    /// Adds drives ahead: the first n channels are driven from now on for `seconds`.
    void add_ahead(std::size_t n, double seconds);
    /// Returns true if all channels are empty.
    bool empty() const noexcept;
};

/// Returns the history of an array that two players have driven, from both histories at the same moment. In
/// no stretch of time does a channel count as driven for longer than the stretch lasts.
drive_history together(const drive_history& a, const drive_history& b);

/// Drops the stretches that ended longer ago than `older_s`.
void forget(drive_history& h, double older_s);

/// Leaves at most `most` stretches (1 at least) for each channel. The oldest are joined, so that they leave
/// the window later, never sooner.
void coarsen(drive_history& h, std::size_t most);

} // namespace tactor::synth
