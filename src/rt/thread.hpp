// SPDX-License-Identifier: MIT
/// \file
/// Threads with options that std::thread lacks: stack size, policy, name, signals; and what to do where the
/// system refuses them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <pthread.h>

#include <tactor/version.hpp>

namespace tactor::rt {

struct thread_options {
    std::string name;                                  ///< at most 15 characters are visible
    std::size_t stack_bytes = std::size_t{256} * 1024; ///< small: mlockall(MCL_FUTURE) charges all of it
    bool fifo = false;                                 ///< request SCHED_FIFO, reset in children
    int priority = 65;                                 ///< of SCHED_FIFO; lower if RLIMIT_RTPRIO allows less
    /// Sets denormals to zero and uses the finest timer slack.
    bool audio = false;
};

/// A joined thread that blocks every signal, so that the host's own threads get them.
class thread {
public:
    /// Starts `body` after the policy is set. A refusal of SCHED_FIFO is not an error.
    /// \throws std::system_error when the system has no thread left.
    thread(const thread_options& o, std::function<void()> body);
    ~thread();
    thread(const thread&) = delete;
    thread& operator=(const thread&) = delete;

    void join() noexcept;
    /// Detaches the thread, for a thread that destroys its owner.
    void detach() noexcept;

    bool is_current() const noexcept;
    /// Returns 0 if SCHED_FIFO was granted, errno if it was refused, -1 if it was not requested.
    int fifo_error() const noexcept { return fifo_error_; }

private:
    pthread_t handle_{};
    bool joinable_ = false;
    int fifo_error_ = -1;
};

/// Returns a sentence for people: what to do if the system refuses SCHED_FIFO at this priority, or memory of
/// this size.
std::string realtime_advice(const realtime_rights& r, int priority);

} // namespace tactor::rt
