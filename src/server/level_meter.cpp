// SPDX-License-Identifier: MIT
#include "server/level_meter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace tactor::server {
namespace {

float magnitude(const std::byte* p, format_kind f) noexcept
{
    const auto at = [p](int i) { return static_cast<std::uint32_t>(p[i]); };
    switch (f) {
    case format_kind::float32: {
        float v = 0.0F;
        std::memcpy(&v, p, sizeof v);
        return std::abs(v);
    }
    case format_kind::s16:
        return std::abs(static_cast<float>(static_cast<std::int16_t>(at(0) | at(1) << 8U))) / 32768.0F;
    case format_kind::s24_3:
    case format_kind::s24_4: {
        const std::uint32_t bits = at(0) << 8U | at(1) << 16U | at(2) << 24U;
        return std::abs(static_cast<float>(static_cast<std::int32_t>(bits))) / 2147483648.0F;
    }
    case format_kind::s32:
        break;
    }
    std::int32_t v = 0;
    std::memcpy(&v, p, sizeof v);
    return std::abs(static_cast<float>(v)) / 2147483648.0F;
}

class meter_sink final : public sink {
public:
    meter_sink(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks)
        : inner_(std::move(s)), peaks_(std::move(peaks))
    {
    }

    const stream_setup& setup() const noexcept override { return inner_->setup(); }
    io_kind prepare() noexcept override { return inner_->prepare(); }
    io_kind start() noexcept override { return inner_->start(); }
    io_kind resume() noexcept override { return inner_->resume(); }
    std::int64_t xrun_ns() noexcept override { return inner_->xrun_ns(); }
    std::size_t max_descriptors() const noexcept override { return inner_->max_descriptors(); }
    std::size_t descriptors(std::span<pollfd> f) noexcept override { return inner_->descriptors(f); }
    io_kind ready(std::span<pollfd> f) noexcept override { return inner_->ready(f); }
    io_result available() noexcept override { return inner_->available(); }
    stream_position position() noexcept override { return inner_->position(); }
    void drop() noexcept override { inner_->drop(); }

    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const io_result r = inner_->write(frames);
        if (peaks_->listens())
            look(frames.data(), r.frames);
        return r;
    }

private:
    void look(const std::byte* data, std::size_t frames) noexcept
    {
        const stream_setup& s = inner_->setup();
        const std::size_t step = sample_bytes(s.format);
        const std::size_t channels = std::min<std::size_t>(s.channels, peaks_->size());
        for (std::size_t c = 0; c < channels; ++c) {
            float most = 0.0F;
            for (std::size_t f = 0; f < frames; ++f)
                most = std::max(most, magnitude(data + (f * s.channels + c) * step, s.format));
            if (most > 0.0F)
                peaks_->raise(c, most);
        }
    }

    std::unique_ptr<sink> inner_;
    std::shared_ptr<level_peaks> peaks_;
};

} // namespace

void level_peaks::raise(std::size_t channel, float peak) noexcept
{
    std::atomic<float>& p = peaks_[channel];
    float seen = p.load(std::memory_order_relaxed);
    // The other side only ever takes it to 0: a second try is enough.
    while (peak > seen && !p.compare_exchange_weak(seen, peak, std::memory_order_relaxed)) {
    }
}

float level_peaks::take(std::size_t channel) noexcept
{
    return peaks_[channel].exchange(0.0F, std::memory_order_relaxed);
}

std::unique_ptr<sink> metered(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks)
{
    return std::make_unique<meter_sink>(std::move(s), std::move(peaks));
}

} // namespace tactor::server
