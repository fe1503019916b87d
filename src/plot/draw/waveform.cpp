// SPDX-License-Identifier: MIT
#include "plot/draw/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "synth/mix/sample_ranges.hpp"

namespace tactor::plot {
namespace {

constexpr double most_samples = 2e10;
constexpr std::size_t most_block_samples = 1U << 16U;

} // namespace

waveform look_at(const score& s, const std::vector<unsigned>& channels, std::size_t stretches)
{
    const std::uint64_t frames = s.frames();
    const double samples = static_cast<double>(frames) * s.channels();
    if (samples > most_samples)
        throw error(error_kind::bad_input, "--view wave",
                    fmt::format("{:.3g} samples are too many to look at", samples),
                    "plot a shorter piece, or ask for a lower --rate");
    const std::size_t per_frame = s.channels();
    const auto block = std::max<std::size_t>(1, most_block_samples / per_frame);
    const std::uint64_t length =
        std::max<std::uint64_t>(1, (frames + stretches - 1) / std::max<std::size_t>(1, stretches));
    waveform w;
    w.stretch_s = static_cast<double>(length) / s.rate();
    w.by_channel.assign(channels.size(), std::vector<sample_range>((frames + length - 1) / length));
    w.peaks.assign(channels.size(), 0.0F);
    renderer r(s, format_kind::float32);
    synth::sample_ranges ranges(per_frame);
    std::vector<float> buffer(block * per_frame);
    for (std::uint64_t at = 0; at < frames;) {
        // No block crosses from one stretch to the next.
        const auto n = static_cast<std::size_t>(
            std::min({static_cast<std::uint64_t>(block), frames - at, length - at % length}));
        r.process(std::as_writable_bytes(std::span(buffer).first(n * per_frame)));
        if (!r.failure().empty())
            throw error(error_kind::bad_input, "stroke", r.failure());
        ranges.add(buffer.data(), n);
        at += n;
        if (at % length != 0 && at != frames)
            continue;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const auto [low, high] = ranges.of(channels[c]);
            w.by_channel[c][(at - 1) / length] = {low, high};
            w.peaks[c] = std::max({w.peaks[c], std::abs(low), std::abs(high)});
        }
        ranges.clear();
    }
    return w;
}

} // namespace tactor::plot
