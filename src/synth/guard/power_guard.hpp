// SPDX-License-Identifier: MIT
/// \file
/// How much power all tactors together may be given.
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
    const double* envelope = nullptr; ///< squared, in each frame at least the square of the sample
};

/// Holds the sum over the channels of the squared envelopes, and with it that of x^2, at or below a limit in
/// every frame, without a click: the gain of all follows the envelopes, not the waves, and takes about 10 ms.
/// Where an envelope rises faster than that, its rise waits for the headroom that the gain makes: channels
/// that sound already are never cut off, and one that begins fades in. The gain comes back with
/// a time constant of 50 ms. State changes frame by frame, so that block sizes make no
/// difference.
class power_guard {
public:
    /// `most`: greatest sum of squares; not finite: no limit. `reach`: the greatest sum that `channels`
    /// channels could reach.
    power_guard(std::size_t channels, double most, double reach, unsigned rate);

    /// Whether it can ever act.
    bool on() const noexcept { return on_; }
    /// Whether a block that cannot exceed this sum of squares passes as it is.
    bool passes(double sum_of_squares) const noexcept
    {
        return !on_ || (held_ <= most_ && gain_ >= 1.0 && sum_of_squares <= most_ * (1.0 - 1e-12));
    }
    /// To be called after a block that passes: the squared envelopes in its last frame matter to the next
    /// block.
    void passed(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Scales n frames of the channels, at most block_frames; returns how many it changed.
    std::uint64_t apply(std::span<const powered_channel> channels, unsigned n) noexcept;
    /// Time passes in silence.
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
    double near_ = 1.0; ///< half-way smoothed
    double gain_ = 1.0; ///< of all
    /// By channel: the squared envelope in the frame before, as far as it was let through, without gain_.
    std::vector<double> let_;
    std::vector<double> other_; ///< takes the place of let_ from block to block
};

} // namespace tactor::synth
