// SPDX-License-Identifier: MIT
/// \file
/// Drives the amplifier's line as the audio thread's reports require, and watches that thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include <tactor/lines.hpp>

#include "amplifier/amplifier.hpp"
#include "engine/link.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

struct driver_options {
    amplifier::sequence_options amplifier{};
    std::int64_t beat_ns = 40'000'000;      ///< the holder waits for 150 ms
    std::int64_t watchdog_ns = 100'000'000; ///< time without a period after which the audio thread is stalled
    std::int64_t retry_ns = 10'000'000;     ///< between two tries to switch off
    std::int64_t persist_ns = 1'000'000'000; ///< time for which a refused "off" is tried again
};

/// Driver of the line, without a thread; one caller at a time. The line's set() may block, so the caller must
/// not be the audio thread. Nor may it be the thread of the program's handlers: a slow handler could keep the
/// holder waiting.
class amplifier_driver {
public:
    /// Starts with the line off. `clock`: CLOCK_MONOTONIC, ns. The references must outlive the driver.
    amplifier_driver(link& l, enable_line& line, const driver_options& o,
                     std::function<std::int64_t()> clock);

    /// Handles events. Call it after each wake-up, at the latest next_ns() after the previous call.
    void update() noexcept;
    std::int64_t next_ns() const noexcept;
    /// Switches off at once, for good. If the line refuses, update() tries again while trying() is true.
    void close() noexcept;
    /// Returns true while a refused "off" is tried again.
    bool trying() const noexcept { return line_state_ == line_state::refused && !stuck_; }

private:
    void read_status(const stream_status& s, std::int64_t now) noexcept;
    void watch(const stream_status& s, std::int64_t now) noexcept;
    void beat(std::int64_t now) noexcept;
    void apply() noexcept;
    void report_changes() noexcept;
    void switch_on() noexcept;
    void switch_off() noexcept;
    void try_off() noexcept;
    void fail() noexcept;

    link& link_;
    enable_line& line_;
    driver_options options_;
    std::function<std::int64_t()> clock_;
    amplifier::sequence amplifier_;
    enum class line_state { off, on, refused }; // refused: the line should be off, and may be on
    line_state line_state_ = line_state::off;
    bool stuck_ = false;          ///< refused for persist_ns
    std::int64_t refused_ns_ = 0; ///< time of the first refusal
    std::int64_t tried_ns_ = 0;   ///< time of the last attempt
    std::uint64_t epoch_ = 0;
    std::uint64_t xruns_ = 0;
    std::uint64_t suspends_ = 0;
    std::uint64_t periods_ = 0;
    std::int64_t idle_ns_ = 0; ///< time in which no period was written
    std::int64_t updated_ns_ = 0;
    std::int64_t beaten_ns_ = 0;
    bool stalled_ = false;
    bool reported_ready_ = false;
    std::uint64_t reported_events_ = 0;
};

/// Thread of an amplifier_driver. The audio thread and time wake it.
class amplifier_thread {
public:
    /// \throws std::system_error when no thread can be started.
    amplifier_thread(link& l, enable_line& line, const driver_options& o, const rt::thread_options& t);
    /// Switches off if the line is on. Blocks while the line refuses and is tried again.
    ~amplifier_thread();
    amplifier_thread(const amplifier_thread&) = delete;
    amplifier_thread& operator=(const amplifier_thread&) = delete;

private:
    void run() noexcept;
    void sleep() noexcept;

    link& link_;
    amplifier_driver driver_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

} // namespace tactor::engine
