// SPDX-License-Identifier: MIT
/// \file
/// What the whole array, and one tactor over time, may be given. State changes frame by frame, so that block
/// sizes make no difference; what is within the limits is not touched in a single bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <tactor/render.hpp>

#include "synth/oscillator.hpp"

namespace tactor::synth {

/// Limits in the mixer's units; none as they are.
struct guard_settings {
    double power = std::numeric_limits<double>::infinity(); ///< greatest sum of x^2 over the channels
    std::uint64_t drive_frames = 0;
    std::uint64_t window_frames = 0;
    unsigned rate = 48000;
};

/// Holds the sum over the channels of x^2 at or below a limit in every frame. The gain falls at once, along
/// the wave, and comes back with a time constant of 50 ms.
class power_guard {
public:
    /// `most`: greatest sum of squares; not finite: no limit.
    power_guard(double most, unsigned rate) noexcept;

    /// Whether a block that cannot exceed this sum of squares passes as it is.
    bool passes(double sum_of_squares) const noexcept
    {
        return held_ <= most_ && sum_of_squares <= most_ * (1.0 - 1e-12);
    }
    /// Scales n frames of the channels; returns how many it changed.
    std::uint64_t apply(std::span<double* const> channels, unsigned n) noexcept;
    /// Time passes in silence.
    void silence(std::uint64_t frames) noexcept;

private:
    double most_;
    double decay_;
    double held_; ///< sum of squares that the gain answers to; never below most_
};

/// Cuts a channel that was driven for too long within a window of time, and lets it back when half of that
/// has passed out of the window. Counts on its own clock, frames since the beginning.
class drive_guard {
public:
    static constexpr std::size_t slots = 64; ///< of the window

    /// `limit` and `window` in frames; a limit of 0, or one that is not below the window: none.
    drive_guard(std::size_t channels, std::uint64_t limit, std::uint64_t window, unsigned rate);

    bool on() const noexcept { return !cells_.empty(); }
    /// A block from `clock` on must not be longer than this.
    std::uint64_t longest_block(std::uint64_t clock) const noexcept
    {
        return on() ? slot_ - clock % slot_ : ~std::uint64_t{0};
    }
    /// A channel is driven in frames from ... to - 1, which are in one block. Calls for one channel in
    /// order of `from`.
    void drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept;
    /// Whether a block from `clock` on is not to pass as it is.
    bool acts(std::size_t channel, std::uint64_t clock) noexcept;
    /// Applies what came of it to such a block.
    void apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x) const noexcept;
    /// How often a channel was cut.
    std::uint64_t cuts() const noexcept { return cuts_; }

private:
    struct cell {
        std::array<std::uint32_t, slots> driven{};
        std::uint64_t sum = 0;
        std::uint64_t slot = 0;      ///< the newest that `driven` knows
        std::uint64_t covered = 0;   ///< up to here it was counted
        std::int64_t changed_at = 0; ///< frame at which the fade in or out began
        bool closed = false;
    };
    void turn_to(cell& c, std::uint64_t slot) noexcept;
    double gain(const cell& c, std::int64_t at) const noexcept;

    std::uint64_t limit_;
    std::uint64_t slot_;
    std::int64_t fade_;
    std::vector<cell> cells_;
    std::uint64_t cuts_ = 0;
};

/// A drive below this peak (-40 dBFS) heats nothing and does not count.
inline constexpr double least_counted_drive = 0.01;

/// \throws error (bad_input) for what is not a limit.
void check_limits(const drive_limits& l);
/// Limits at a sample rate. Throws like check_limits.
guard_settings guards_of(const drive_limits& l, unsigned rate);

} // namespace tactor::synth
