// SPDX-License-Identifier: MIT
/// \file
/// Limit on the power of all tactors together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactor::synth {

/// A channel in one block.
struct powered_channel {
    std::size_t channel = 0;
    double* x = nullptr;              ///< samples
    const double* envelope = nullptr; ///< squared; in each frame at least the square of the sample
};

/// Limits the sum over the channels of the squared envelopes, and with it that of x^2, in every frame,
/// without a click: the gain of all follows the envelopes, not the waves, and takes about 10 ms. If an
/// envelope rises faster, its rise waits for the headroom that the gain makes: channels that already sound
/// are never cut off, and one that begins fades in. The gain returns with a time constant of 50 ms. State
/// changes frame by frame, so block sizes make no difference.
class power_guard {
public:
    /// Makes a guard. `most`: greatest sum of squares; infinite: no limit. `reach`: greatest sum that the
    /// channels could reach.
    power_guard(std::size_t channels, double most, double reach, unsigned rate);

    /// Returns true if it can ever act.
    bool on() const noexcept { return on_; }
    /// Returns true if a block that cannot exceed this sum of squares passes unchanged.
    bool passes(double sum_of_squares) const noexcept
    {
        return !on_ || (held_ <= most_ && gain_ >= 1.0 && sum_of_squares <= most_ * (1.0 - 1e-12));
    }
    /// Call it after a block that passes: the squared envelopes of its last frame matter to the next block.
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
    double near_ = 1.0; ///< after the first stage of smoothing
    double gain_ = 1.0; ///< gain of all channels
    /// By channel: squared envelope of the frame before, as far as it passed, without gain_.
    std::vector<double> let_;
    std::vector<double> other_; ///< exchanged with let_ from block to block
};

} // namespace tactor::synth
