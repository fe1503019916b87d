// SPDX-License-Identifier: MIT
#include "rt/thread.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <limits>
#include <string>

#include <linux/capability.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "rt/clock.hpp"

namespace thread_test {

using namespace tactor;
using rt::thread;

constexpr std::int64_t ms = 1'000'000;

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

namespace helping {

std::atomic<bool> helps = false;
std::atomic<pid_t> thread = 0;
std::atomic<int> priority = 0;
std::atomic<bool> body_ran = false;
bool ran_before = false;

bool help(pid_t t, int p) noexcept
{
    thread = t;
    priority = p;
    ran_before = body_ran;
    return helps;
}

/// Takes the right to SCHED_FIFO from this thread and those that it starts, and gives it back.
class without_right {
public:
    without_right()
    {
        ::syscall(SYS_capget, &version_, before_.data());
        auto none = before_;
        none[0].effective &= ~(1U << CAP_SYS_NICE);
        ::syscall(SYS_capset, &version_, none.data());
        ::getrlimit(RLIMIT_RTPRIO, &limit_);
        const rlimit zero{.rlim_cur = 0, .rlim_max = limit_.rlim_max};
        ::setrlimit(RLIMIT_RTPRIO, &zero);
    }
    ~without_right()
    {
        ::syscall(SYS_capset, &version_, before_.data());
        ::setrlimit(RLIMIT_RTPRIO, &limit_);
    }
    without_right(const without_right&) = delete;
    without_right& operator=(const without_right&) = delete;

private:
    __user_cap_header_struct version_{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
    std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> before_{};
    rlimit limit_{};
};

} // namespace helping

TEST_CASE("a helper gets a thread to which SCHED_FIFO is refused, before the thread works")
{
    const helping::without_right none;
    for (const bool helps : {true, false}) {
        helping::helps = helps;
        helping::thread = helping::priority = 0;
        helping::body_ran = false;
        rt::set_realtime_helper(helping::help);
        pid_t id = 0;
        thread t({.name = "t", .fifo = true, .priority = 65}, [&id] {
            helping::body_ran = true;
            id = ::gettid();
        });
        rt::set_realtime_helper(nullptr);
        t.join();
        CHECK(helping::thread == id);
        CHECK(helping::priority == 65);
        CHECK_FALSE(helping::ran_before);
        CHECK(t.fifo_error() == (helps ? 0 : EPERM));
        helping::thread = 0;
        thread without({.name = "t", .fifo = true}, [] {});
        thread ordinary({.name = "t"}, [] {});
        CHECK(helping::thread == 0);
    }
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

TEST_CASE("60 ms of work without a pause are too long, after any history")
{
    rt::busy_time t;
    CHECK_FALSE(t.too_long(5000 * ms, 7)); // set-up counts for nothing
    CHECK_FALSE(t.too_long(5059 * ms, 7));
    CHECK(t.too_long(5060 * ms, 7));
}

TEST_CASE("a thread that waits now and then may work for ever")
{
    rt::busy_time t;
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
            rt::busy_time t;
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
        rt::busy_watch w;
        const bool fifo = (sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
        const std::int64_t hangs_ns = rt::monotonic_ns() + 300'000 * ms;
        while (fifo && !w.look(rt::monotonic_ns()) && rt::monotonic_ns() < hangs_ns) {
        }
        policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
        again = w.look(rt::monotonic_ns() + 1000 * ms);
    });
    spinning.join();
    CHECK(policy == SCHED_OTHER);
    CHECK_FALSE(again);
    // Without SCHED_FIFO only checks that the watch leaves other threads alone.
    WARN(spinning.fifo_error() == 0);
}

TEST_CASE("reported rights are granted, and others are not")
{
    const realtime_rights r = probe_realtime_rights();
    CHECK(r.priority >= 0);
    CHECK(r.priority <= sched_get_priority_max(SCHED_FIFO));
    // A lower limit than asked for still gives a thread of that priority.
    int granted = 0;
    thread t({.name = "t", .fifo = true, .priority = 65}, [&granted] {
        sched_param p{};
        if (sched_getscheduler(0) != SCHED_OTHER && sched_getparam(0, &p) == 0)
            granted = p.sched_priority;
    });
    t.join();
    CHECK((t.fifo_error() == 0) == (granted > 0));
    if (r.priority == 0)
        CHECK(granted == 0);
    if (granted > 0)
        CHECK(granted == std::min(65, r.priority));
}

TEST_CASE("the hint is one line with the limits, the group and the unit")
{
    const std::string text = rt::realtime_hint({.priority = 0, .lockable_bytes = 8U << 20}, 65);
    CHECK(text.find('\n') == std::string::npos);
    if (geteuid() == 0) {
        CHECK(text.find("SYS_NICE") != std::string::npos);
        return;
    }
    for (const char* part : {"rtprio", "memlock", "limits.d", "group audio", "LimitRTPRIO"}) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
}

TEST_CASE("where all limits allow it, the hint is another")
{
    const std::string text = rt::realtime_hint({.priority = 99, .lockable_bytes = {}}, 65);
    CHECK(text.find("rtprio") == std::string::npos);
    CHECK(text.find("sched_rt_runtime_us") != std::string::npos);
}

} // namespace thread_test
