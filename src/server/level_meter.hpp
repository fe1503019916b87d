// SPDX-License-Identifier: MIT
/// \file
/// A sink in front of the device that remembers each channel's largest sample, as it was written: after all
/// limits.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include <tactor/sink.hpp>

namespace tactor::server {

/// Peaks by channel, between the audio thread, which writes them, and the thread that asks.
class level_peaks {
public:
    explicit level_peaks(std::size_t channels) : peaks_(channels) {}

    /// Switches the meter on or off: it costs time only while a client asks.
    void listen(bool on) noexcept { on_.store(on, std::memory_order_relaxed); }
    bool listens() const noexcept { return on_.load(std::memory_order_relaxed); }
    std::size_t size() const noexcept { return peaks_.size(); }

    /// Notes the magnitude of a sample, full scale 1. The audio thread calls it.
    void raise(std::size_t channel, float peak) noexcept;
    /// Returns the largest magnitude since the last call; 0 after silence.
    float take(std::size_t channel) noexcept;

private:
    std::vector<std::atomic<float>> peaks_;
    std::atomic<bool> on_{false};
};

/// Returns a sink that passes everything on to `s` and measures the written samples.
std::unique_ptr<sink> metered(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks);

} // namespace tactor::server
