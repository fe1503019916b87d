// SPDX-License-Identifier: MIT
/// \file
/// Limit on the time for which one tactor is driven.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "synth/guard/drive_history.hpp"

namespace tactor::synth {

/// Greatest envelope that does not count as drive (-40 dBFS, with a margin for rounding): it does not heat a
/// tactor.
inline constexpr double least_counted_drive = 0.01 * (1.0 + 1e-9);

/// Limits the time for which a channel is driven within a sliding window. A channel that has used its limit
/// is faded out; it may go on when the window holds half of the limit. No window holds more than the limit
/// and one fade of 20 ms. Time is counted in cells of 1/256 of the window: a channel that starts more than
/// once in a cell may be cut up to a cell too early.
/// Counts on its own clock, frames since the start; nothing depends on block sizes.
class drive_guard {
public:
    /// Makes a guard. `limit` and `window` in frames; a limit of 0, or one not below the window, means no
    /// limit.
    drive_guard(std::size_t channels, std::uint64_t limit, std::uint64_t window, unsigned rate);

    bool on() const noexcept { return !cells_.empty(); }
    /// Returns the longest block that may be passed.
    std::uint64_t longest_block() const noexcept
    {
        return on() ? static_cast<std::uint64_t>(fade_) : ~std::uint64_t{0};
    }
    /// Counts a drive in frames from ... to - 1, which are in one block. Calls for one channel come in order
    /// of `from`. Returns false if a part of it is changed.
    bool drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept;
    /// Counts a block of n frames that begins with frame `clock`, by its squared envelope.
    void follow(std::size_t channel, std::uint64_t clock, const double* envelope, unsigned n) noexcept;
    /// Returns true if such a block must be changed. Known once its drive has been counted.
    bool acts(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept;
    /// Applies the resulting gain to the block, and to the squared envelope from the block's frame `known`
    /// on.
    void apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x, double* envelope,
               unsigned known) noexcept;
    /// Returns the number of changed drives: cut short, or silent because their channel was closed, also by
    /// an earlier guard. A drive that sounds again within 1 ms is the same drive.
    std::uint64_t cuts() const noexcept { return cuts_; }

    /// Returns the drives that were counted until frame `clock` and are still in the window. Allocates.
    drive_history history(std::uint64_t clock) const;
    /// Continues from a history with frame 0. Call it only before the first drive.
    void resume(const drive_history& h) noexcept;

private:
    static constexpr std::size_t grains = 256; ///< of the window

    /// Frames begin ... end - 1, of which `driven` were driven: all, unless it started again within a grain.
    struct stretch {
        std::int64_t begin = 0;
        std::int64_t end = 0;
        std::int64_t driven = 0;
    };
    /// State of a channel. Stretches begin a grain or more apart, so those of one window fit.
    struct cell {
        std::array<stretch, grains + 4> ring{};
        std::size_t first = 0;
        std::size_t count = 0;
        std::int64_t sum = 0; ///< frames in the stretches
        std::int64_t closed_at = 0;
        std::int64_t opens_at = 0;
        /// Last sample that was changed.
        std::int64_t changed_at = std::numeric_limits<std::int64_t>::min() / 2;

        stretch& at(std::size_t i) noexcept { return ring[(first + i) % ring.size()]; }
        const stretch& at(std::size_t i) const noexcept { return ring[(first + i) % ring.size()]; }
    };
    void add(cell& c, const stretch& s) const noexcept;
    static void release(cell& c, std::int64_t begin) noexcept;
    void close(cell& c, std::int64_t at) noexcept;
    std::int64_t half_gone(const cell& c) const noexcept;
    double gain(const cell& c, std::int64_t at) const noexcept;

    unsigned rate_;
    std::int64_t limit_;
    std::int64_t window_;
    std::int64_t grain_;
    std::int64_t fade_;
    std::int64_t pause_;
    std::vector<cell> cells_;
    std::uint64_t cuts_ = 0;
};

} // namespace tactor::synth
