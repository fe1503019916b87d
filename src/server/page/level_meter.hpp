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

/// Between the audio thread, which writes, and the one that asks.
class level_peaks {
public:
    explicit level_peaks(std::size_t channels) : peaks_(channels) {}

    /// Nothing is looked at while nobody asks.
    void listen(bool on) noexcept { on_.store(on, std::memory_order_relaxed); }
    bool listens() const noexcept { return on_.load(std::memory_order_relaxed); }
    std::size_t size() const noexcept { return peaks_.size(); }

    /// The audio thread: a sample of a channel, full scale 1, without its sign.
    void raise(std::size_t channel, float peak) noexcept;
    /// The largest since the last call; 0 where there was silence.
    float take(std::size_t channel) noexcept;

private:
    std::vector<std::atomic<float>> peaks_;
    std::atomic<bool> on_{false};
};

/// Passes everything on to `s` and looks at what is written.
std::unique_ptr<sink> metered(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks);

} // namespace tactor::server
