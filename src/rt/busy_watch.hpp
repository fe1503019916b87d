// SPDX-License-Identifier: MIT
/// \file
/// A real-time thread's own limit on the processor. Under SCHED_FIFO one that never waits keeps its processor
/// from everybody else, and RLIMIT_RTTIME would end the process.
#pragma once

#include <cstdint>

namespace tactor::rt {

/// How long a thread has worked since it last waited. Pure: readings in.
class busy_time {
public:
    /// Longest that may be seen. What was worked before the first look is not in it, nor what comes until
    /// the next: of pieces of work of up to 95 ms, with a look after each, less than 200 ms pass until it is
    /// too long, which is RLIMIT_RTTIME where rtkit or the tool sets it.
    static constexpr std::int64_t most_ns = 60'000'000;
    /// Whether it is too long now. `cpu_ns`: processor time of the thread; `waits`: how often it has waited.
    bool too_long(std::int64_t cpu_ns, long waits) noexcept
    {
        if (waits != waits_)
            rested_ns_ = cpu_ns;
        waits_ = waits;
        return cpu_ns - rested_ns_ >= most_ns;
    }

private:
    std::int64_t rested_ns_ = 0; ///< processor time at the first look since it waited
    long waits_ = -1;
};

/// Of the thread that makes it. Nothing allocates or waits.
class busy_watch {
public:
    busy_watch() noexcept;
    /// Between two pieces of work, at CLOCK_MONOTONIC `now_ns`. True when the thread has just given up real
    /// time, once. A system call 50 times a second.
    bool look(std::int64_t now_ns) noexcept;

private:
    static constexpr std::int64_t pause_ns = 20'000'000;

    busy_time busy_;
    std::int64_t next_ns_ = 0;
    bool on_;
};

} // namespace tactor::rt
