// SPDX-License-Identifier: MIT
#include "rt/busy_watch.hpp"

#include <ctime>

#include <sched.h>
#include <sys/resource.h>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace tactor::rt {
namespace {

bool is_realtime() noexcept
{
    const permitted_call here{};
    const int policy = sched_getscheduler(0);
    return policy >= 0 && (policy & ~SCHED_RESET_ON_FORK) != SCHED_OTHER;
}

} // namespace

busy_watch::busy_watch() noexcept : on_(is_realtime())
{
}

bool busy_watch::look() noexcept
{
    const permitted_call here{};
    timespec t{};
    if (!on_ || ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) != 0 || !busy_.due(to_ns(t)))
        return false;
    rusage u{};
    if (::getrusage(RUSAGE_THREAD, &u) != 0 || !busy_.too_long(to_ns(t), u.ru_nvcsw))
        return false;
    on_ = false;
    const sched_param none{};
    // The flag cannot be taken back without a right that the thread may not have.
    return sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &none) == 0;
}

} // namespace tactor::rt
