// SPDX-License-Identifier: MIT
#include "synth/score/score_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/access.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/own_samples.hpp"

namespace tactor::synth {

namespace {

double amplitude_at(const channel_line& l, std::uint32_t points, std::uint64_t frame) noexcept
{
    const auto end = l.frame.begin() + points;
    const auto after = std::upper_bound(l.frame.begin(), end, frame);
    const auto i = static_cast<std::size_t>(after - l.frame.begin());
    if (after == end)
        return l.amplitude[i - 1];
    const double part = static_cast<double>(frame - l.frame[i - 1]) / (l.frame[i] - l.frame[i - 1]);
    return l.amplitude[i - 1] + part * (l.amplitude[i] - l.amplitude[i - 1]);
}

} // namespace

sounding_now::sounding_now(const score& s)
    : score_(s), source_(s), energy_(s.channels()), levels_(detail::access::of(s).tactors.size())
{
}

const std::vector<double>& sounding_now::at(std::uint64_t frame)
{
    frame = latest_ = std::max(frame, latest_);
    for (const drive_event* e = source_.peek(); e != nullptr && e->start <= frame; e = source_.peek()) {
        if (e->start + e->length > frame)
            open_.push_back(*e);
        source_.pop();
    }
    std::erase_if(open_, [frame](const drive_event& e) { return e.start + e.length <= frame; });
    energy_.assign(energy_.size(), 0.0);
    for (const drive_event& e : open_) {
        const double part = static_cast<double>(frame - e.start) / e.length;
        const auto add = [this](std::uint32_t channel, double a) { energy_[channel] += a * a; };
        const bool is_own = e.sound != nullptr && !e.sound->is_steady();
        const double envelope = is_own ? e.sound->own->envelope(frame - e.start) : 1.0;
        for (std::uint32_t i = 0; i < e.drives; ++i) {
            const channel_drive& d = e.drive[i];
            add(d.channel, envelope * (d.from + part * (d.to - d.from)));
        }
        if (e.points != 0)
            add(e.line.channel, amplitude_at(e.line, e.points, frame - e.start));
    }
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const tactor_level& t = detail::access::of(score_).tactors[i];
        levels_[i] = std::sqrt(energy_[t.channel]) / std::abs(t.gain);
    }
    return levels_;
}

namespace {

constexpr std::size_t vector_floats = 16; // floats in the widest vector
constexpr std::size_t most_floats = 2048; // floats in a row: both rows stay in the fastest cache

/// Widens the ranges to include `rows` rows of `length` samples, which are stored one after the other.
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
