// SPDX-License-Identifier: MIT
/// \file
/// Limits that protect tactors: the peak of each channel, the power of all channels together, and the drive
/// time of each channel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/render.hpp>

namespace tactor::synth {

/// Limits in the mixer's units. The initial values set no limits.
struct guard_settings {
    double power = std::numeric_limits<double>::infinity(); ///< greatest sum of squared envelopes
    double drive_frames = 0.0; ///< maximum level of drive time; 0: drive time is not counted
    double leak = 1.0;         ///< frames of drive time that one frame of rest removes
    unsigned rate = 48000;
};

/// Converts limits to a sample rate.
/// \throws error (bad_input) for impossible limits.
guard_settings make_guards(const drive_limits& l, unsigned rate);

/// Clamps n samples to -limit ... limit; NaN becomes 0. Returns the number of samples that were changed by
/// more than rounding noise.
std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept;

/// Returns the limit of each of the array's channels (10^(max_dbfs / 20)), for `channels` channels; 0 for
/// channels without a tactor.
std::vector<double> channel_limits(const array& a, unsigned channels);

/// Returns true if limit_block() cannot change samples of at most `peak`; false for NaN.
inline bool is_within_limit(double peak, double limit) noexcept
{
    return peak <= limit * (1.0 - 1e-12);
}

/// Returns the limit, clamped to 0 ... 1; NaN becomes 0.
inline double clamp_limit(double l) noexcept
{
    return l > 0.0 ? std::min(l, 1.0) : 0.0;
}

/// A channel in one block.
struct powered_channel {
    std::size_t channel = 0;
    double* x = nullptr;              ///< samples
    const double* envelope = nullptr; ///< squared envelope; never below the square of the sample
};

/// Guard of power. It limits the sum of the channels' squared envelopes in every frame, and with it the sum
/// of x^2. It does not click, because the common gain follows the envelopes, not the waves, and takes about
/// 10 ms to change. A channel whose envelope rises faster is held back until the gain has made headroom.
/// Channels that sound are never cut off, and a channel that begins fades in. The gain recovers with a time
/// constant of 50 ms. State changes frame by frame, so results do not depend on block sizes.
class power_guard {
public:
    /// Makes a guard. `most`: maximum sum of squares; infinite for no limit. `reach`: greatest sum that the
    /// channels can reach.
    power_guard(std::size_t channels, double most, double reach, unsigned rate);

    /// Returns true if the guard can ever act.
    bool on() const noexcept { return on_; }
    /// Returns true if a block that cannot exceed this sum of squares passes unchanged.
    bool passes(double sum_of_squares) const noexcept
    {
        return !on_ || (held_ <= most_ && gain_ >= 1.0 && sum_of_squares <= most_ * (1.0 - 1e-12));
    }
    /// Records a block that passes unchanged. The next block needs the squared envelopes of its last frame.
    void record_unchanged_block(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Scales n frames of the channels, at most block_frames. Returns the number of changed frames.
    std::uint64_t apply(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Advances the time in silence.
    void silence(std::uint64_t frames) noexcept;

private:
    void step(double sum) noexcept;
    void keep(std::span<const powered_channel> channels) noexcept;
    void admit(std::span<const powered_channel> channels, unsigned frame) noexcept;
    void distribute_headroom(std::span<const powered_channel> channels, unsigned frame, double sum,
                             double headroom) noexcept;

    double most_;
    bool on_;
    double decay_;
    double blend_;
    double held_;       ///< greatest recent sum; never below most_
    double near_ = 1.0; ///< gain after the first stage of smoothing
    double gain_ = 1.0; ///< gain of all channels
    /// Squared envelope that was let through on each channel in the previous frame, without gain_.
    std::vector<double> let_;
    std::vector<double> other_; ///< exchanged with let_ from block to block
};

/// Greatest envelope that does not count as drive (-40 dBFS, with a margin for rounding), because it does not
/// heat a tactor.
inline constexpr double least_counted_drive = 0.01 * (1.0 + 1e-9);

/// Guard of drive time: a leaky bucket for each channel. The level of a channel rises while the channel is
/// driven and falls while it rests. A frame that would raise the level above the limit closes the channel: it
/// fades out, and opens again when the level has fallen to half of the limit. Frames count since the start.
/// Results do not depend on block sizes.
class drive_guard {
public:
    /// Makes a guard. If guard_settings::drive_frames is 0, the guard is off and counts nothing.
    drive_guard(std::size_t channels, const guard_settings& g);

    bool on() const noexcept { return !cells_.empty(); }
    /// Returns the maximum length of a block.
    std::uint64_t max_block_frames() const noexcept
    {
        return on() ? static_cast<std::uint64_t>(fade_) : ~std::uint64_t{0};
    }
    /// Counts a drive in frames `from` to `to` - 1, which are in one block. Call it in order of `from` for
    /// each channel.
    void drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept;
    /// Counts the drive in a block of n frames that begins at frame `clock`, from the squared envelope.
    void follow(std::size_t channel, std::uint64_t clock, const double* envelope, unsigned n) noexcept;
    /// Returns true if the guard changes that block. Call it after the drive in the block has been counted.
    bool changes_block(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept;
    /// Applies the guard's gain to the samples of the block, and to the squared envelope from the block's
    /// frame `known` on.
    void apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x, double* envelope,
               unsigned known) noexcept;
    /// Returns the number of drives that were cut short, or were silent because their channel was closed. A
    /// drive that sounds again within 1 ms counts as the same drive.
    std::uint64_t cuts() const noexcept { return cuts_; }

    /// Returns the number of frames in which a channel was driven; 0 while the guard is off.
    std::uint64_t driven(std::size_t channel) const noexcept { return on() ? cells_[channel].driven : 0; }
    /// Raises the level of a channel to `level_s`, a level in seconds that other programs have reached. A
    /// level at the limit closes the channel, beginning with the block at frame `clock`.
    void raise(std::size_t channel, std::uint64_t clock, double level_s) noexcept;

private:
    struct cell {
        double level = 0.0;   ///< frames, at frame `at`
        std::int64_t at = -1; ///< frame up to which drives are counted
        std::uint64_t driven = 0;
        std::int64_t closed_at = 0;
        std::int64_t opens_at = 0;
        /// Last sample that was changed.
        std::int64_t changed_at = std::numeric_limits<std::int64_t>::min() / 2;
    };
    void rest(cell& c, std::int64_t until) const noexcept;
    static void add(cell& c, std::int64_t frames) noexcept;
    void close(cell& c) const noexcept;
    void set_opening_time(cell& c) const noexcept;
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
