// SPDX-License-Identifier: MIT
/// \file
/// The stream of the service. A worker thread opens and closes the device. A timer in the context does
/// everything else.
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

/// Peaks of each channel. The audio thread writes them, and another thread reads them.
class level_peaks {
public:
    explicit level_peaks(std::size_t channels) : peaks_(channels) {}

    /// Switches the meter on or off. It is on only while a client subscribes to levels, because it takes
    /// processor time.
    void listen(bool on) noexcept { on_.store(on, std::memory_order_relaxed); }
    bool listens() const noexcept { return on_.load(std::memory_order_relaxed); }
    std::size_t size() const noexcept { return peaks_.size(); }

    /// Records the magnitude of a sample. Full scale is 1. Called in the audio thread.
    void raise(std::size_t channel, float peak) noexcept;
    /// Returns the greatest magnitude since the last call, or 0 if there was only silence.
    float take(std::size_t channel) noexcept;

private:
    std::vector<std::atomic<float>> peaks_;
    std::atomic<bool> on_{false};
};

/// Wraps a sink. Measures samples as they are written to the device, after all limits.
std::unique_ptr<sink> add_meter(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks);

struct stream_options : session::stream_parts {
    std::function<void(stream_state, const std::string& reason)> changed = {};
    /// Called if the configuration can never be opened, but only after the first attempt. Then no other
    /// handler is called. If a later attempt fails, the stream tries again, because the device may have been
    /// replaced.
    std::function<void(std::exception_ptr)> refused = {};
};

/// Returns a duplicate of a descriptor. \throws std::system_error.
int copy_descriptor(int descriptor);

/// The stream of the service. Call the members in the context's thread. All handlers run in this thread.
class stream : public session::device_stream {
public:
    stream(boost::asio::io_context& io, stream_options o);
    ~stream();
    stream(const stream&) = delete;
    stream& operator=(const stream&) = delete;

    /// Begins to open the device.
    void start() { go_on(); }
    /// Calls `ready` when it is known whether there is a player. If it is already known, calls `ready`
    /// immediately.
    void call_when_ready(std::function<void()> ready);
    level_peaks& peaks() noexcept { return *peaks_; }
    /// Returns true if the audio thread has made progress since the last call, or if it has nothing to do.
    bool has_progressed();
    /// Sets whether there are strokes. The stream stops when there have been no strokes for some time.
    void set_has_strokes(bool is);
    /// Cancels all strokes. Begins with those that are playing.
    void cancel_all();
    /// Fades out and closes the stream. Calls `done` when the end of each stroke has been reported.
    void close(std::function<void()> done);

private:
    static session::stream_parts make_parts(stream& s, session::stream_parts p);
    void hand_over(std::function<void()> report);
    void pass_report();
    bool has_no_reports();
    void await_news();
    void go_on();
    void report_state();
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
    std::deque<std::function<void()>> reports_; ///< starts and ends of strokes, from the player's threads
    std::uint64_t seen_periods_ = 0;
    boost::asio::steady_timer again_;
    boost::asio::posix::stream_descriptor news_;
    boost::asio::thread_pool worker_{1};
};

} // namespace tactor::server
