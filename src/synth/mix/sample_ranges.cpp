// SPDX-License-Identifier: MIT
#include "synth/mix/sample_ranges.hpp"

#include <algorithm>
#include <limits>

namespace tactor::synth {

namespace {

constexpr std::size_t vector_floats = 16; // of the widest vectors
constexpr std::size_t most_floats = 2048; // of a row: both rows stay in the fastest cache

/// Widens the ranges by `rows` rows of `length` samples, one below the other.
void widen(const float* samples, std::size_t rows, std::size_t length, float* low, float* high) noexcept
{
    float* __restrict least = low;
    float* __restrict most = high;
    for (std::size_t r = 0; r < rows; ++r) {
        const float* __restrict in = samples + r * length;
        for (std::size_t j = 0; j < length; ++j) {
            least[j] = in[j] < least[j] ? in[j] : least[j];
            most[j] = in[j] > most[j] ? in[j] : most[j];
        }
    }
}

} // namespace

sample_ranges::sample_ranges(std::size_t channels)
    : channels_(channels),
      abreast_(std::clamp<std::size_t>(most_floats / std::max<std::size_t>(channels, 1), 1, vector_floats)),
      low_(channels * abreast_),
      high_(channels * abreast_)
{
    clear();
}

void sample_ranges::clear() noexcept
{
    std::fill(low_.begin(), low_.end(), std::numeric_limits<float>::infinity());
    std::fill(high_.begin(), high_.end(), -std::numeric_limits<float>::infinity());
}

void sample_ranges::add(const float* samples, std::size_t frames) noexcept
{
    const std::size_t rows = frames / abreast_;
    widen(samples, rows, low_.size(), low_.data(), high_.data());
    widen(samples + rows * low_.size(), frames % abreast_, channels_, low_.data(), high_.data());
}

sample_ranges::range sample_ranges::range_at(std::size_t channel) const noexcept
{
    range all{low_[channel], high_[channel]};
    for (std::size_t i = channel; i < low_.size(); i += channels_) {
        all.low = std::min(all.low, low_[i]);
        all.high = std::max(all.high, high_[i]);
    }
    return all;
}

} // namespace tactor::synth
