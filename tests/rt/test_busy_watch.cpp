// SPDX-License-Identifier: MIT
// A real-time thread that never waits gives up real time.
#include "rt/busy_watch.hpp"

#include <cstdint>

#include <sched.h>

#include <doctest/doctest.h>

#include "rt/clock.hpp"
#include "rt/thread.hpp"

namespace busy_watch_test {

using tactor::rt::busy_time;
using tactor::rt::busy_watch;
using tactor::rt::thread;

namespace {

constexpr std::int64_t ms = 1'000'000;

} // namespace

TEST_CASE("100 ms of work without a pause are too long, whatever went before")
{
    busy_time t;
    CHECK_FALSE(t.too_long(5000 * ms, 7)); // set-up counts for nothing
    CHECK_FALSE(t.too_long(5099 * ms, 7));
    CHECK(t.too_long(5100 * ms, 7));
}

TEST_CASE("a thread that waits now and then may work for ever")
{
    busy_time t;
    for (long waits = 0; waits < 1000; ++waits) {
        REQUIRE_FALSE(t.too_long(waits * 100 * ms, waits));
        REQUIRE_FALSE(t.too_long(waits * 100 * ms + 99 * ms, waits));
    }
    CHECK(t.too_long(1000 * 100 * ms, 999));
}

TEST_CASE("a thread with real-time priority that spins loses it, and is told so once")
{
    int policy = -1;
    bool again = true;
    thread spinning({.name = "t", .fifo = true}, [&] {
        busy_watch w;
        const bool fifo = (sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
        while (fifo && !w.look(tactor::rt::monotonic_ns())) {
        }
        policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
        again = w.look(tactor::rt::monotonic_ns() + 1000 * ms);
    });
    spinning.join();
    CHECK(policy == SCHED_OTHER);
    CHECK_FALSE(again);
    // Else nothing was seen but that the watch leaves other threads alone.
    WARN(spinning.fifo_error() == 0);
}

} // namespace busy_watch_test
