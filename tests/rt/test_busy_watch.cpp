// SPDX-License-Identifier: MIT
// A real-time thread that never waits, and gives up real time.
#include "rt/busy_watch.hpp"

#include <algorithm>
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

TEST_CASE("60 ms of work without a pause are too long, after any history")
{
    busy_time t;
    CHECK_FALSE(t.too_long(5000 * ms, 7)); // set-up counts for nothing
    CHECK_FALSE(t.too_long(5059 * ms, 7));
    CHECK(t.too_long(5060 * ms, 7));
}

TEST_CASE("a thread that waits now and then may work for ever")
{
    busy_time t;
    for (long waits = 0; waits < 1000; ++waits) {
        REQUIRE_FALSE(t.too_long(waits * 100 * ms, waits));
        REQUIRE_FALSE(t.too_long(waits * 100 * ms + 59 * ms, waits));
    }
    CHECK(t.too_long(1000 * 100 * ms, 999));
}

TEST_CASE("for pieces of work of any length, a thread is warned before the kernel would end it")
{
    for (std::int64_t piece = 1; piece <= 95; ++piece) {
        CAPTURE(piece);
        for (std::int64_t late = 1; late <= std::max<std::int64_t>(20, piece); ++late) {
            busy_time t;
            std::int64_t worked = late; // by the first check since it waited
            std::int64_t looked = worked;
            REQUIRE_FALSE(t.too_long(worked * ms, 0));
            for (bool told = false; !told;) {
                worked += piece;
                if (worked - looked < 20)
                    continue;
                looked = worked;
                told = t.too_long(worked * ms, 0);
            }
            CHECK(worked < 200);
        }
    }
}

TEST_CASE("a spinning thread with real-time priority loses it, and is warned once")
{
    int policy = -1;
    bool again = true;
    thread spinning({.name = "t", .fifo = true}, [&] {
        busy_watch w;
        const bool fifo = (sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
        const std::int64_t hangs_ns = tactor::rt::monotonic_ns() + 300'000 * ms;
        while (fifo && !w.look(tactor::rt::monotonic_ns()) && tactor::rt::monotonic_ns() < hangs_ns) {
        }
        policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
        again = w.look(tactor::rt::monotonic_ns() + 1000 * ms);
    });
    spinning.join();
    CHECK(policy == SCHED_OTHER);
    CHECK_FALSE(again);
    // Else only checks that the watch leaves other threads alone.
    WARN(spinning.fifo_error() == 0);
}

} // namespace busy_watch_test
