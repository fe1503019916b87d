// SPDX-License-Identifier: MIT
/// \file
/// The service's stream: a worker thread opens and closes the device, a timer does the rest.
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

/// Peaks by channel, which the audio thread writes and another thread reads.
class level_peaks {
public:
    explicit level_peaks(std::size_t channels) : peaks_(channels) {}

    /// Switches the meter on or off: it costs time only while a client subscribes to levels.
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
    /// Called instead of all others if the configuration can never be opened, only after the first attempt.
    /// Later the device may be another one, and is tried again.
    std::function<void(std::exception_ptr)> refused = {};
};

/// Returns a copy of a descriptor for another owner. \throws std::system_error.
int copy_descriptor(int descriptor);

/// A stream whose members are called in the context's thread. All handlers run there.
class stream : public session::device_stream {
public:
    stream(boost::asio::io_context& io, stream_options o);
    ~stream();
    stream(const stream&) = delete;
    stream& operator=(const stream&) = delete;

    /// Begins to open the device.
    void start() { go_on(); }
    /// Calls `ready` once it is known if there is a player; at once if that is known already.
    void when_ready(std::function<void()> ready);
    level_peaks& peaks() noexcept { return *peaks_; }
    /// Returns true if the audio thread has made progress since the last call, or need not.
    bool progresses();
    /// Notes that there are strokes, or none: after a time without strokes the stream stops.
    void busy(bool is);
    /// Cancels all strokes, the sounding ones first.
    void cancel_all();
    /// Fades out and closes; calls `done` when all strokes have been reported.
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
    std::function<void(std::exception_ptr)> refused_; ///< empty after the first attempt to open the device
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
