// SPDX-License-Identifier: MIT
/// \file
/// Limit on the time for which one tactor is driven.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "synth/guard/guard.hpp"

namespace tactor::synth {

/// Greatest envelope that does not count as drive (-40 dBFS, with a margin for rounding): it does not heat a
/// tactor.
inline constexpr double least_counted_drive = 0.01 * (1.0 + 1e-9);

/// Drive time as a bucket a channel: its level rises while the channel is driven and leaks while it rests. A
/// frame that would bring it above the limit closes the channel: it is faded out, and opens again when the
/// level is at half of the limit. Counts on its own clock, frames since the start; nothing depends on block
/// sizes.
class drive_guard {
public:
    /// Makes a guard. Without guard_settings::drive_frames it is off and counts nothing.
    drive_guard(std::size_t channels, const guard_settings& g);

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
    /// Returns the number of changed drives: cut short, or silent because their channel was closed. A drive
    /// that sounds again within 1 ms is the same drive.
    std::uint64_t cuts() const noexcept { return cuts_; }

    /// Returns the frames in which a channel was driven so far; 0 while the guard is off.
    std::uint64_t driven(std::size_t channel) const noexcept { return on() ? cells_[channel].driven : 0; }
    /// Begins with these levels, s, at frame 0. Call it only before the first drive.
    void resume(std::span<const double> levels_s) noexcept;

private:
    struct cell {
        double level = 0.0;  ///< frames, at frame `at`
        std::int64_t at = 0; ///< frame up to which drives are counted
        std::uint64_t driven = 0;
        std::int64_t closed_at = 0;
        std::int64_t opens_at = 0;
        /// Last sample that was changed.
        std::int64_t changed_at = std::numeric_limits<std::int64_t>::min() / 2;
    };
    void rest(cell& c, std::int64_t until) const noexcept;
    static void add(cell& c, std::int64_t frames) noexcept;
    void close(cell& c) const noexcept;
    double gain(const cell& c, std::int64_t at) const noexcept;

    double rate_;
    double limit_;
    double leak_;
    std::int64_t fade_;
    std::int64_t pause_;
    std::vector<cell> cells_;
    std::uint64_t cuts_ = 0;
};

} // namespace tactor::synth
