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
    /// Longest that may be; RLIMIT_RTTIME is 200 ms where rtkit or the tool sets it.
    static constexpr std::int64_t most_ns = 100'000'000;
    /// Readings of how often it has waited cost a call: one in so much work.
    static constexpr std::int64_t look_ns = 10'000'000;

    /// Whether it is worth while to ask how often the thread has waited. `cpu_ns`: its processor time.
    bool due(std::int64_t cpu_ns) const noexcept { return cpu_ns - looked_ns_ >= look_ns; }
    /// Whether it is too long now. `waits`: how often the thread has waited by then.
    bool too_long(std::int64_t cpu_ns, long waits) noexcept
    {
        if (waits != waits_)
            rested_ns_ = cpu_ns;
        waits_ = waits;
        looked_ns_ = cpu_ns;
        return cpu_ns - rested_ns_ >= most_ns;
    }

private:
    std::int64_t rested_ns_ = 0; ///< processor time at the first look since it waited
    std::int64_t looked_ns_ = 0;
    long waits_ = -1;
};

/// Of the thread that makes it. Nothing allocates or waits.
class busy_watch {
public:
    busy_watch() noexcept;
    /// Between two pieces of work. True when the thread has just given up real time, once.
    bool look() noexcept;

private:
    busy_time busy_;
    bool on_;
};

} // namespace tactor::rt
