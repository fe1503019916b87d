// SPDX-License-Identifier: MIT
/// \file
/// Figures for pictures of a score: drive of each tactor at one time, and range of each channel's samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactor/render.hpp>

#include "synth/score/event_source.hpp"

namespace tactor::synth {

/// Levels of the tactors along a score. Keeps only the drives that sound. Control side, one thread at a time.
class sounding_now {
public:
    explicit sounding_now(const score& s);

    /// Returns the amplitude of each tactor in a frame of the score, by index; 1 is the requested intensity.
    /// Frames must not decrease; an earlier frame counts as the latest one. Valid until the next call.
    const std::vector<double>& at(std::uint64_t frame);

private:
    score score_;
    event_source source_;
    std::uint64_t latest_ = 0;
    std::vector<drive_event> open_; ///< drives that have begun and are not over
    std::vector<double> energy_;    ///< by channel, at full level
    std::vector<double> levels_;
};

/// Minimum and maximum sample of each channel over all frames added so far. As fast as making the samples.
class sample_ranges {
public:
    explicit sample_ranges(std::size_t channels);

    void add(const float* samples, std::size_t frames) noexcept;

    struct range {
        float low = 0.0F;
        float high = 0.0F;
    };
    /// Returns the range of a channel. \pre there was a frame.
    range range_at(std::size_t channel) const noexcept;

    /// Forgets all frames.
    void clear() noexcept;

private:
    std::size_t channels_;
    std::size_t abreast_; ///< number of frames that are compared together, in whole vectors
    std::vector<float> low_;
    std::vector<float> high_;
};

} // namespace tactor::synth
