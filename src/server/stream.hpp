// SPDX-License-Identifier: MIT
/// \file
/// The service's stream: a worker opens and closes the device, one timer does the rest.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>

#include <tactor/sink.hpp>

#include "session/device_stream.hpp"

namespace tactor::server {

using session::stream_state;

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

/// Returns a sink in front of the device that measures samples as they were written: after all limits.
std::unique_ptr<sink> metered(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks);

struct stream_options : session::stream_parts {
    std::function<void(stream_state, const std::string& reason)> changed = {};
    /// Called instead of all others if the configuration can never be opened. Only after the first attempt:
    /// later the device may be another one, and is tried again.
    std::function<void(std::exception_ptr)> refused = {};
};

/// A stream whose members are called in the context's thread. All handlers run there.
class stream : public session::device_stream {
public:
    stream(boost::asio::io_context& io, stream_options o);
    ~stream();
    stream(const stream&) = delete;
    stream& operator=(const stream&) = delete;

    /// Begins to open the device.
    void start() { go_on(); }
    /// Calls `ready` once there is a player, or it is known that there is none; at once if that is known.
    void when_ready(std::function<void()> ready);
    level_peaks& peaks() noexcept { return *peaks_; }
    /// Returns true if the audio thread has gone on since the last call, or has no reason to.
    bool progresses();
    /// Notes that strokes go on, or that there are none: the stream stops after a time without.
    void busy(bool is);
    /// Cancels all strokes, first those that sound.
    void cancel_all();
    /// Fades out and closes; calls `done` when all strokes were reported.
    void close(std::function<void()> done);

private:
    static session::stream_parts make_parts(stream& s, session::stream_parts p);
    void hand_over(std::function<void()> report);
    void pass_report();
    bool all_passed();
    void await_news();
    void go_on();
    void tell();
    bool is_ready() const;

    boost::asio::io_context& io_;
    std::function<void(stream_state, const std::string&)> changed_;
    std::function<void(std::exception_ptr)> refused_; ///< empty once the device was tried
    std::shared_ptr<level_peaks> peaks_;
    std::pair<stream_state, std::string> told_;
    std::deque<std::function<void()>> waiting_;
    bool busy_ = false;
    std::function<void()> closed_;
    std::mutex reports_mutex_;
    std::deque<std::function<void()>> reports_; ///< beginnings and ends of strokes, from the player's threads
    std::uint64_t seen_periods_ = 0;
    boost::asio::steady_timer again_;
    boost::asio::posix::stream_descriptor news_;
    boost::asio::thread_pool worker_{1};
};

} // namespace tactor::server
