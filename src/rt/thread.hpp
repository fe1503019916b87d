// SPDX-License-Identifier: MIT
/// \file
/// Threads with what std::thread cannot say: stack size, policy, name, signals.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <pthread.h>

namespace tactor::rt {

struct thread_options {
    std::string name;                                  ///< at most 15 characters are shown
    std::size_t stack_bytes = std::size_t{256} * 1024; ///< small: mlockall(MCL_FUTURE) charges all of it
    bool fifo = false;                                 ///< ask for SCHED_FIFO, reset in children
    int priority = 65; ///< of SCHED_FIFO; less where RLIMIT_RTPRIO allows no more
    /// Denormals to zero and the finest timer slack.
    bool audio = false;
};

/// A joined thread in which every signal is blocked, so that the host's own threads get them.
class thread {
public:
    /// Starts `body` once the policy has been settled. SCHED_FIFO that is refused is not an error.
    /// \throws std::system_error when there is no thread to be had.
    thread(const thread_options& o, std::function<void()> body);
    ~thread();
    thread(const thread&) = delete;
    thread& operator=(const thread&) = delete;

    void join() noexcept;
    /// Lets it go on by itself: for a thread that gives up what owns it.
    void detach() noexcept;

    /// Whether this is the calling thread.
    bool is_current() const noexcept;
    /// 0 when SCHED_FIFO was granted, else why not (errno); -1 when it was not asked for.
    int fifo_error() const noexcept { return fifo_error_; }

private:
    pthread_t handle_{};
    bool joinable_ = false;
    int fifo_error_ = -1;
};

} // namespace tactor::rt
