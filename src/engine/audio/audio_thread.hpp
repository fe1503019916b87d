// SPDX-License-Identifier: MIT
/// \file
/// The audio thread: an audio_loop that waits on real descriptors.
#pragma once

#include <memory>
#include <vector>

#include <poll.h>

#include "engine/audio/audio_loop.hpp"
#include "rt/nonblocking.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

class audio_thread {
public:
    /// Starts the stream and, with it, the thread. The references must outlive it.
    /// \throws std::system_error when no thread can be started.
    audio_thread(audio_loop& loop, sink& s, link& l, const rt::thread_options& o);

    const io_result& started() const noexcept { return started_; }
    int fifo_error() const noexcept { return thread_->fifo_error(); }
    void join() noexcept { thread_->join(); }

private:
    void run() noexcept TACTOR_NONBLOCKING;
    io_kind wait() noexcept;

    audio_loop& loop_;
    sink& sink_;
    link& link_;
    std::vector<pollfd> fds_; ///< the sink's, then the eventfd
    io_result started_;
    std::unique_ptr<rt::thread> thread_;
};

} // namespace tactor::engine
