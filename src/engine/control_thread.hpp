// SPDX-License-Identifier: MIT
/// \file
/// The control thread: Boost.Asio, woken by the audio thread.
#pragma once

#include <functional>
#include <list>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "rt/event_fd.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

/// Calls `woken` in its own thread for each signal of an eventfd. GPIO edges, sockets and timers get
/// their place beside it in the same io_context.
class control_thread {
public:
    /// \throws std::system_error when there is no thread to be had.
    control_thread(rt::event_fd& e, std::function<void()> woken);
    /// Ends the thread; `woken` is not called any more.
    ~control_thread();

    /// Calls `readable` in the control thread whenever a descriptor is readable, until it returns false. The
    /// descriptor stays the caller's and must live as long as this object. Any thread.
    void watch(int fd, std::function<bool()> readable);

    bool is_current() const noexcept { return thread_.is_current(); }

private:
    struct watched {
        boost::asio::posix::stream_descriptor descriptor;
        std::function<bool()> readable;
    };

    void wait();
    void wait(watched& w);

    rt::event_fd& event_;
    std::function<void()> woken_;
    boost::asio::io_context context_;
    boost::asio::posix::stream_descriptor descriptor_;
    std::list<watched> watched_; ///< control thread only
    rt::thread thread_;
};

} // namespace tactor::engine
