// SPDX-License-Identifier: MIT
/// \file
/// Drives the amplifier's line after what the audio thread says of the stream, and looks after that thread.
#pragma once

#include <cstdint>
#include <functional>

#include <tactor/gpio.hpp>

#include "engine/amplifier.hpp"
#include "engine/link.hpp"

namespace tactor::engine {

struct driver_options {
    amplifier_options amplifier{};
    std::int64_t beat_ns = 40'000'000;      ///< the holder waits for 150 ms
    std::int64_t watchdog_ns = 100'000'000; ///< an audio thread that writes nothing for so long is stalled
};

/// One thread at a time, without one of its own. It may block in the line's set(), so this is neither the
/// audio thread nor the one that runs the program's handlers, which could keep the holder waiting.
class amplifier_driver {
public:
    /// `clock`: CLOCK_MONOTONIC, ns. The references must outlive it.
    amplifier_driver(link& l, enable_line& line, const driver_options& o,
                     std::function<std::int64_t()> clock);

    /// After each wake-up, and next_ns() after the last one at the latest.
    void update() noexcept;
    std::int64_t next_ns() const noexcept;
    /// Off at once, for good.
    void close() noexcept;

private:
    void hear(const stream_status& s, std::int64_t now) noexcept;
    void watch(const stream_status& s, std::int64_t now) noexcept;
    void beat(std::int64_t now) noexcept;
    void apply() noexcept;
    void switch_on() noexcept;
    void switch_off() noexcept;
    void fail() noexcept;

    link& link_;
    enable_line& line_;
    driver_options options_;
    std::function<std::int64_t()> clock_;
    amplifier amplifier_;
    bool on_ = false;
    stream_stage stage_ = stream_stage::idle;
    std::uint64_t epoch_ = 0;
    std::uint64_t xruns_ = 0;
    std::uint64_t periods_ = 0;
    std::int64_t idle_ns_ = 0; ///< for so long no period was written
    std::int64_t updated_ns_ = 0;
    std::int64_t beaten_ns_ = 0;
    bool stalled_ = false;
};

} // namespace tactor::engine
