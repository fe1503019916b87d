// SPDX-License-Identifier: MIT
/// \file
/// For how long each channel was driven lately: what outlives a mixer, so that a device that is opened again
/// does not give a tactor its time back.
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

    /// So much time went by in silence since: what was still to come then came, as far as it went by.
    void pass(double seconds) noexcept;
    /// What is still to come does not.
    void end_now() noexcept;
    /// Each of so many channels is driven from now on for so long.
    void add_ahead(std::size_t n, double seconds);
    /// Whether all channels are.
    bool empty() const noexcept;
};

/// Of an array that two have driven, taken at the same moment: what one alone says and what both say. No
/// channel counts as driven for longer than there was time.
drive_history together(const drive_history& a, const drive_history& b);

/// What ended longer ago than that is no longer in it.
void forget(drive_history& h, double older_s);

/// At most so many stretches a channel, the oldest taken together: what counts leaves the window later then,
/// never sooner. `most` is 1 at least.
void coarsen(drive_history& h, std::size_t most);

} // namespace tactor::synth
