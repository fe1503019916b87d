// SPDX-License-Identifier: MIT
/// \file
/// Limit of a real-time thread on its own processor time. Under SCHED_FIFO a thread that never waits keeps
/// its processor from all others, and RLIMIT_RTTIME would end the process.
#pragma once

#include <cstdint>

namespace tactor::rt {

/// Work of a thread since it last waited. Pure: it gets readings.
class busy_time {
public:
    /// Longest work that is allowed, ns, as far as it is seen: work before the first look and after the last
    /// is not. With pieces of work of up to 95 ms and a look after each, less than 200 ms pass until the
    /// limit acts. That is RLIMIT_RTTIME as rtkit and the tool set it.
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

/// Watch on the thread that constructs it. Does not allocate or wait.
class busy_watch {
public:
    busy_watch() noexcept;
    /// Looks between two pieces of work, at CLOCK_MONOTONIC `now_ns`. Returns true once, when it has just
    /// given up real-time priority. Makes a system call 50 times a second.
    bool look(std::int64_t now_ns) noexcept;

private:
    static constexpr std::int64_t pause_ns = 20'000'000;

    busy_time busy_;
    std::int64_t next_ns_ = 0;
    bool on_;
};

} // namespace tactor::rt
