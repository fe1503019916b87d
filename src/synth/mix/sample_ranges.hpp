// SPDX-License-Identifier: MIT
/// \file
/// Least and greatest sample of each channel, found as fast as samples are made.
#pragma once

#include <cstddef>
#include <vector>

namespace tactor::synth {

/// Ranges over all interleaved frames that are added.
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

    /// Begins anew.
    void clear() noexcept;

private:
    std::size_t channels_;
    std::size_t abreast_; ///< frames that are compared next to each other, in whole vectors
    std::vector<float> low_;
    std::vector<float> high_;
};

} // namespace tactor::synth
