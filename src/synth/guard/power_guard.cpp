// SPDX-License-Identifier: MIT
#include "synth/guard/power_guard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "synth/mix/oscillator.hpp"

namespace tactor::synth {
namespace {

// Time constant of each of two smoothing stages: the gain has no corner, and its changes have no content
// above 1 kHz.
constexpr double smooth_s = 0.002;
constexpr double release_s = 0.05;
constexpr double noise = 1e-9;

} // namespace

power_guard::power_guard(std::size_t channels, double most, double reach, unsigned rate)
    // The allowed number of full-scale channels may exceed the limit by rounding noise.
    : most_(std::isfinite(most) ? most * (1.0 + noise) : std::numeric_limits<double>::infinity()),
      on_(reach > most_),
      decay_(std::exp(-1.0 / (release_s * rate))),
      blend_(-std::expm1(-1.0 / (smooth_s * rate))),
      held_(most_),
      let_(on_ ? channels : 0),
      other_(let_)
{
}

void power_guard::step(double sum) noexcept
{
    held_ = std::max({most_, sum, held_ * decay_});
    const double target = held_ > most_ ? std::sqrt(most_ / held_) : 1.0;
    near_ += blend_ * (target - near_);
    gain_ += blend_ * (near_ - gain_);
    if (target >= 1.0 && std::min(near_, gain_) > 1.0 - noise)
        near_ = gain_ = 1.0;
}

void power_guard::admit(std::span<const powered_channel> channels, unsigned frame) noexcept
{
    for (const powered_channel& c : channels)
        let_[c.channel] = c.envelope[frame];
}

void power_guard::passed(std::span<const powered_channel> channels, unsigned n) noexcept
{
    std::fill(let_.begin(), let_.end(), 0.0);
    admit(channels, n - 1);
}

/// Keeps the state of the channels that sound. A channel that is silent in a block starts anew.
void power_guard::keep(std::span<const powered_channel> channels) noexcept
{
    std::fill(other_.begin(), other_.end(), 0.0);
    for (const powered_channel& c : channels)
        other_[c.channel] = let_[c.channel];
    let_.swap(other_);
}

/// Handles a sum above the headroom. Falling and constant channels keep their gain; rising ones share the
/// rest of the headroom.
void power_guard::squeeze(std::span<const powered_channel> channels, unsigned frame, double sum,
                          double headroom) noexcept
{
    double base = 0.0;
    for (const powered_channel& c : channels)
        base += std::min(let_[c.channel], c.envelope[frame]);
    const double scale = base > headroom ? headroom / base : 1.0;
    const double rise = base < headroom ? (headroom - base) / (sum - base) : 0.0;
    for (const powered_channel& c : channels) {
        const double wanted = c.envelope[frame];
        const double had = std::min(let_[c.channel], wanted);
        const double let = scale * had + rise * (wanted - had);
        let_[c.channel] = let;
        c.x[frame] *= gain_ * (let < wanted ? std::sqrt(let / wanted) : 1.0);
    }
}

std::uint64_t power_guard::apply(std::span<const powered_channel> channels, unsigned n) noexcept
{
    std::array<double, block_frames> sum{};
    for (const powered_channel& c : channels)
        for (unsigned j = 0; j < n; ++j)
            sum[j] += c.envelope[j];
    keep(channels);
    std::uint64_t changed = 0;
    bool squeezed = true; // in the frame before, so let_ is known
    for (unsigned j = 0; j < n; ++j) {
        step(sum[j]);
        const double headroom = most_ / (gain_ * gain_);
        const bool fits = sum[j] <= headroom * (1.0 + noise);
        changed += fits && gain_ >= 1.0 ? 0 : 1;
        if (!fits) {
            if (!squeezed)
                admit(channels, j - 1);
            squeeze(channels, j, sum[j], headroom);
        }
        sum[j] = fits ? gain_ : 1.0;
        squeezed = !fits;
    }
    if (changed > 0) {
        for (const powered_channel& c : channels)
            for (unsigned j = 0; j < n; ++j)
                c.x[j] *= sum[j];
    }
    if (!squeezed)
        admit(channels, n - 1);
    return changed;
}

void power_guard::silence(std::uint64_t frames) noexcept
{
    std::fill(let_.begin(), let_.end(), 0.0);
    for (; frames > 0 && !passes(0.0); --frames)
        step(0.0);
}

} // namespace tactor::synth
