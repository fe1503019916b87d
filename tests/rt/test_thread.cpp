// SPDX-License-Identifier: MIT
#include "rt/thread.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <limits>
#include <string>

#include <sched.h>
#include <sys/prctl.h>

#include <doctest/doctest.h>

namespace thread_test {

using tactor::rt::thread;

TEST_CASE("a thread has its name, its stack and no signals")
{
    std::array<char, 16> name{};
    std::size_t stack = 0;
    sigset_t mask;
    sigemptyset(&mask);
    thread t({.name = "tactor-a-long-name", .stack_bytes = 512 * 1024}, [&] {
        pthread_getname_np(pthread_self(), name.data(), name.size());
        pthread_attr_t a;
        pthread_getattr_np(pthread_self(), &a);
        pthread_attr_getstacksize(&a, &stack);
        pthread_attr_destroy(&a);
        pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    });
    t.join();
    CHECK(std::string(name.data()) == "tactor-a-long-n");
    CHECK(stack >= 512 * 1024);
    CHECK(stack < 1024 * 1024);
    CHECK(sigismember(&mask, SIGINT) == 1);
    CHECK(sigismember(&mask, SIGTERM) == 1);
    CHECK(t.fifo_error() == -1);
}

TEST_CASE("the starting thread keeps its own signals")
{
    sigset_t before;
    sigset_t after;
    pthread_sigmask(SIG_SETMASK, nullptr, &before);
    thread t({.name = "t"}, [] {});
    pthread_sigmask(SIG_SETMASK, nullptr, &after);
    for (int s = 1; s < 32; ++s)
        CHECK(sigismember(&before, s) == sigismember(&after, s));
}

TEST_CASE("SCHED_FIFO is either granted with the reset flag, or refused with a reason")
{
    int policy = -1;
    thread t({.name = "t", .fifo = true, .priority = 1000}, [&] { policy = sched_getscheduler(0); });
    t.join();
    if (t.fifo_error() == 0)
        CHECK(policy == (SCHED_FIFO | SCHED_RESET_ON_FORK));
    else
        CHECK(t.fifo_error() == EPERM);
}

TEST_CASE("an audio thread flushes denormals and has the finest timer slack; others do not")
{
    for (const bool audio : {false, true}) {
        CAPTURE(audio);
        double half = -1.0;
        int slack = 0;
        thread t({.name = "t", .audio = audio}, [&] {
            volatile double least = std::numeric_limits<double>::min();
            half = least / 2;
            slack = prctl(PR_GET_TIMERSLACK);
        });
        t.join();
#if defined(__SSE2__) || defined(__aarch64__)
        CHECK((half == 0.0) == audio);
#endif
        if (t.fifo_error() != 0)
            CHECK((slack == 1) == audio);
    }
}

TEST_CASE("a thread knows itself")
{
    bool outside = true;
    const thread* self = nullptr;
    bool inside = false;
    std::atomic<bool> go{false};
    {
        thread t({.name = "t"}, [&] {
            go.wait(false);
            inside = self->is_current();
        });
        self = &t;
        outside = t.is_current();
        go = true;
        go.notify_one();
    }
    CHECK(inside);
    CHECK_FALSE(outside);
}

} // namespace thread_test
