// SPDX-License-Identifier: MIT
/// \file
/// A DAC without a device. Its time passes only when the fuzzer moves its clock.
#pragma once

#include <cstdint>
#include <memory>

#include <tactor/sink.hpp>

namespace tactor::fuzz {

/// The clock of one sink. One thread calls make_sink() and step().
class stepped_clock {
public:
    /// Begins at 1000 s. `s` needs name, channels, rate, period_frames and buffer_frames.
    explicit stepped_clock(stream_setup s);
    ~stepped_clock();
    stepped_clock(const stepped_clock&) = delete;
    stepped_clock& operator=(const stepped_clock&) = delete;

    /// Makes the sink that plays by this clock. It may outlive the clock. Call it once.
    std::unique_ptr<sink> make_sink();

    /// Plays one period, and blocks until the audio thread has written the next one and reported.
    void step();
    /// Returns the time that the sink's positions have, ns. Any thread may call it.
    std::int64_t now_ns() const noexcept;

private:
    struct state;
    class stepped_sink;
    std::shared_ptr<state> state_;
};

} // namespace tactor::fuzz
