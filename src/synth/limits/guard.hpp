// SPDX-License-Identifier: MIT
/// \file
/// Limits that protect tactors: each channel's own, on the power of all together, and on the drive time of
/// each.
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

/// Limits in the mixer's units; as initialised: no limits.
struct guard_settings {
    double power = std::numeric_limits<double>::infinity(); ///< greatest sum of squared envelopes
    double drive_frames = 0.0;                              ///< longest drive; 0: drive time is not counted
    double leak = 1.0; ///< frames of drive time that one frame of rest removes
    unsigned rate = 48000;
};

/// Converts limits to a sample rate.
/// \throws error (bad_input) for impossible limits.
guard_settings make_guards(const drive_limits& l, unsigned rate);

/// Limits n samples to -limit ... limit; NaN becomes 0. Returns the number of changed samples, not counting
/// rounding noise.
std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept;

/// Returns the limits of an array's channels (10^(max_dbfs / 20)) for `channels` channels; 0 for channels
/// without a tactor.
std::vector<double> channel_limits(const array& a, unsigned channels);

/// Returns true if limit_block() cannot change samples of at most `peak`; false for NaN.
inline bool within_limit(double peak, double limit) noexcept
{
    return peak <= limit * (1.0 - 1e-12);
}

/// Returns the limit, clamped to 0 ... 1; NaN becomes 0.
inline double clean_limit(double l) noexcept
{
    return l > 0.0 ? std::min(l, 1.0) : 0.0;
}

/// A channel in one block.
struct powered_channel {
    std::size_t channel = 0;
    double* x = nullptr;              ///< samples
    const double* envelope = nullptr; ///< squared; in each frame at least the square of the sample
};

/// Guard that limits the sum of the squared envelopes over the channels (and so that of x^2) in every frame,
/// without a click: the common gain follows the envelopes, not the waves, and takes about 10 ms. If an
/// envelope rises faster, it waits for the headroom that the gain makes. Sounding channels are never cut off,
/// and one that begins fades in. The gain returns with a time constant of 50 ms. State changes frame by
/// frame, so block sizes make no difference.
class power_guard {
public:
    /// Makes a guard. `most`: greatest sum of squares; infinite: no limit. `reach`: greatest sum that the
    /// channels could reach.
    power_guard(std::size_t channels, double most, double reach, unsigned rate);

    /// Returns true if the guard can ever act.
    bool on() const noexcept { return on_; }
    /// Returns true if a block that cannot exceed this sum of squares passes unchanged.
    bool passes(double sum_of_squares) const noexcept
    {
        return !on_ || (held_ <= most_ && gain_ >= 1.0 && sum_of_squares <= most_ * (1.0 - 1e-12));
    }
    /// Notes a block that passes, because the squared envelopes of its last frame matter to the next block.
    void passed(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Scales n frames of the channels, at most block_frames. Returns the number of changed frames.
    std::uint64_t apply(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Advances the time in silence.
    void silence(std::uint64_t frames) noexcept;

private:
    void step(double sum) noexcept;
    void keep(std::span<const powered_channel> channels) noexcept;
    void admit(std::span<const powered_channel> channels, unsigned frame) noexcept;
    void squeeze(std::span<const powered_channel> channels, unsigned frame, double sum,
                 double headroom) noexcept;

    double most_;
    bool on_;
    double decay_;
    double blend_;
    double held_;       ///< greatest recent sum; never below most_
    double near_ = 1.0; ///< gain after the first stage of smoothing
    double gain_ = 1.0; ///< gain of all channels
    /// Squared envelope of each channel in the previous frame, as far as it passed, without gain_.
    std::vector<double> let_;
    std::vector<double> other_; ///< exchanged with let_ from block to block
};

/// Greatest envelope that does not count as drive (-40 dBFS, with a margin for rounding): it does not heat a
/// tactor.
inline constexpr double least_counted_drive = 0.01 * (1.0 + 1e-9);

/// Guard of drive time, with a bucket for each channel: its level rises while the channel is driven and leaks
/// while it rests. A frame that would raise the level above the limit closes the channel. It fades out, and
/// opens again when the level is at half of the limit. Counts on its own clock, frames since the start;
/// nothing depends on block sizes.
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
    /// of `from`.
    void drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept;
    /// Counts a block of n frames that begins with frame `clock`, by its squared envelope.
    void follow(std::size_t channel, std::uint64_t clock, const double* envelope, unsigned n) noexcept;
    /// Returns true if such a block must be changed. Known once its drive has been counted.
    bool acts(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept;
    /// Applies the resulting gain to the block, and, from the block's frame `known` on, to the squared
    /// envelope.
    void apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x, double* envelope,
               unsigned known) noexcept;
    /// Returns the number of changed drives: cut short, or silent because their channel was closed. A drive
    /// that sounds again within 1 ms is the same drive.
    std::uint64_t cuts() const noexcept { return cuts_; }

    /// Returns the frames in which a channel was driven so far; 0 while the guard is off.
    std::uint64_t driven(std::size_t channel) const noexcept { return on() ? cells_[channel].driven : 0; }
    /// Raises a channel to a level, s, to which others have driven it. A level at the limit closes the
    /// channel, beginning with the block at frame `clock`.
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
    void open_later(cell& c) const noexcept;
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
