// SPDX-License-Identifier: MIT
/// \file
/// Threads with options that std::thread lacks: stack size, policy, name, signals. Also a limit on the
/// processor time of a real-time thread, and advice for users whose system refuses real-time priority.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include <pthread.h>
#include <sys/types.h>

#include <tactor/version.hpp>

namespace tactor::rt {

struct thread_options {
    std::string name;                                  ///< at most 15 characters are visible
    std::size_t stack_bytes = std::size_t{256} * 1024; ///< small: mlockall(MCL_FUTURE) locks all of it
    bool fifo = false;                                 ///< request SCHED_FIFO, which children do not inherit
    int priority = 65; ///< priority of SCHED_FIFO; lower if RLIMIT_RTPRIO allows less
    /// Sets denormals to zero and uses the finest timer slack.
    bool audio = false;
};

/// Function that asks another program to give a thread of this process SCHED_FIFO, and returns true if it
/// did. May block for a short time.
using realtime_helper = bool (*)(pid_t thread, int priority) noexcept;
/// Sets the helper of this process; null, the initial value, for none. The constructor of a thread calls the
/// helper, in the calling thread, when the system refuses SCHED_FIFO. Any thread.
void set_realtime_helper(realtime_helper h) noexcept;

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
    /// Detaches the thread. For a thread that destroys its owner.
    void detach() noexcept;

    bool is_current() const noexcept { return joinable_ && pthread_equal(handle_, pthread_self()) != 0; }
    /// Returns 0 if SCHED_FIFO was granted, errno if it was refused, -1 if it was not requested.
    int fifo_error() const noexcept { return fifo_error_; }

private:
    pthread_t handle_{};
    bool joinable_ = false;
    int fifo_error_ = -1;
};

/// Work of a thread since it last waited. Pure: the caller passes the readings.
class busy_time {
public:
    /// Maximum work, ns. Work counts from the first look after a wait to the latest look; work before and
    /// after them is not seen. If each piece of work takes at most 95 ms and a look follows it, the limit
    /// acts within 200 ms. That is the RLIMIT_RTTIME that rtkit and the tool set.
    static constexpr std::int64_t most_ns = 60'000'000;
    /// Returns true if the work is too long now. `cpu_ns`: processor time of the thread; `waits`: number of
    /// its waits.
    bool too_long(std::int64_t cpu_ns, long waits) noexcept
    {
        if (waits != waits_)
            rested_ns_ = cpu_ns;
        waits_ = waits;
        return cpu_ns - rested_ns_ >= most_ns;
    }

private:
    std::int64_t rested_ns_ = 0; ///< processor time at the first look after a wait
    long waits_ = -1;
};

/// Limit on the processor time of the thread that constructs it. Under SCHED_FIFO a thread that never waits
/// keeps all other threads off its processor, and RLIMIT_RTTIME would end the process. Does not allocate or
/// wait.
class busy_watch {
public:
    busy_watch() noexcept;
    /// Checks the thread's work; call it between two pieces of work. `now_ns`: CLOCK_MONOTONIC. Returns true
    /// once, when it has just given up real-time priority. Makes a system call 50 times a second.
    bool look(std::int64_t now_ns) noexcept;

private:
    static constexpr std::int64_t pause_ns = 20'000'000;

    busy_time busy_;
    std::int64_t next_ns_ = 0;
    bool on_;
};

/// Returns a sentence for people that says what to do if the system, which gives the rights `r`, refuses
/// SCHED_FIFO at this priority or locked memory.
std::string realtime_hint(const realtime_rights& r, int priority);

} // namespace tactor::rt
