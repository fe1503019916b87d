// SPDX-License-Identifier: MIT
/// \file
/// For how long one tactor may be driven.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "synth/guard/drive_history.hpp"

namespace tactor::synth {

/// A tactor with an envelope of this or below (-40 dBFS, and what rounding makes of it) is not heated, and
/// does not count as driven.
inline constexpr double least_counted_drive = 0.01 * (1.0 + 1e-9);

/// Limits how long a channel is driven within a sliding window of time. A channel that has used up its limit
/// is faded out; it may go on when the window holds half of the limit. No window holds more than the limit
/// and one fade of 20 ms. Time is counted in cells of 1/256 of the window: a channel that begins to be driven
/// more than once in a cell may be cut up to a cell too early.
/// Counts on its own clock, frames since the beginning; nothing depends on the sizes of blocks.
class drive_guard {
public:
    /// `limit` and `window` in frames; a limit of 0, or one that is not below the window: none.
    drive_guard(std::size_t channels, std::uint64_t limit, std::uint64_t window, unsigned rate);

    bool on() const noexcept { return !cells_.empty(); }
    /// A block must not be longer than this.
    std::uint64_t longest_block() const noexcept
    {
        return on() ? static_cast<std::uint64_t>(fade_) : ~std::uint64_t{0};
    }
    /// A channel is driven in frames from ... to - 1, which are in one block. Calls for one channel in
    /// order of `from`. False where a part of it is changed.
    bool drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept;
    /// The same for a block of n frames that begins with frame `clock`, by its squared envelope.
    void follow(std::size_t channel, std::uint64_t clock, const double* envelope, unsigned n) noexcept;
    /// Whether such a block must be changed; known once its drive has been counted.
    bool acts(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept;
    /// Applies the gain that results to the block, and to the squared envelope from the block's frame `known`
    /// on.
    void apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x, double* envelope,
               unsigned known) noexcept;
    /// How many drives were changed: cut short, or silent for being given to a channel that was closed, also
    /// by a guard before this one. What sounds again within 1 ms is the same drive.
    std::uint64_t cuts() const noexcept { return cuts_; }

    /// The drive that was counted until frame `clock` and is still in the window. Allocates.
    drive_history history(std::uint64_t clock) const;
    /// Goes on from a history with frame 0; only before the first drive.
    void resume(const drive_history& h) noexcept;

private:
    static constexpr std::size_t grains = 256; ///< of the window

    /// Driven in `driven` of the frames begin ... end - 1: all of them, unless it began again within a grain.
    struct stretch {
        std::int64_t begin = 0;
        std::int64_t end = 0;
        std::int64_t driven = 0;
    };
    /// Stretches begin a grain or more after each other, so that those of one window have space.
    struct cell {
        std::array<stretch, grains + 4> ring{};
        std::size_t first = 0;
        std::size_t count = 0;
        std::int64_t sum = 0; ///< of what the stretches hold
        std::int64_t closed_at = 0;
        std::int64_t opens_at = 0;
        std::int64_t changed_at = std::numeric_limits<std::int64_t>::min() / 2; ///< last sample that was

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
