// SPDX-License-Identifier: MIT
#include <tactor/version.hpp>

#include <algorithm>
#include <string>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "rt/thread.hpp"

namespace realtime_test {

using namespace tactor;

TEST_CASE("reported rights are granted, and others are not")
{
    const realtime_rights r = probe_realtime_rights();
    CHECK(r.priority >= 0);
    CHECK(r.priority <= sched_get_priority_max(SCHED_FIFO));
    // A lower limit than asked for still gives a thread of that priority.
    int granted = 0;
    rt::thread t({.name = "t", .fifo = true, .priority = 65}, [&granted] {
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
    const std::string text = rt::realtime_advice({.priority = 0, .lockable_bytes = 8U << 20}, 65);
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
    const std::string text = rt::realtime_advice({.priority = 99, .lockable_bytes = {}}, 65);
    CHECK(text.find("rtprio") == std::string::npos);
    CHECK(text.find("sched_rt_runtime_us") != std::string::npos);
}

} // namespace realtime_test
