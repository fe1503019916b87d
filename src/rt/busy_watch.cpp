// SPDX-License-Identifier: MIT
#include "rt/busy_watch.hpp"

#include <sched.h>
#include <sys/resource.h>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace tactor::rt {
namespace {

std::int64_t to_ns(const timeval& t) noexcept
{
    return std::int64_t{t.tv_sec} * ns_per_s + std::int64_t{t.tv_usec} * 1000;
}

bool is_realtime() noexcept
{
    const permitted_call here{};
    const int policy = sched_getscheduler(0);
    return policy >= 0 &&
           ((policy & ~SCHED_RESET_ON_FORK) == SCHED_FIFO || (policy & ~SCHED_RESET_ON_FORK) == SCHED_RR);
}

} // namespace

busy_watch::busy_watch() noexcept : on_(is_realtime())
{
}

bool busy_watch::look(std::int64_t now_ns) noexcept
{
    if (!on_ || now_ns < next_ns_)
        return false;
    next_ns_ = now_ns + pause_ns;
    const permitted_call here{};
    rusage u{};
    if (::getrusage(RUSAGE_THREAD, &u) != 0 ||
        !busy_.too_long(to_ns(u.ru_utime) + to_ns(u.ru_stime), u.ru_nvcsw))
        return false;
    on_ = false;
    const sched_param none{};
    // The thread may lack the right to clear this flag.
    return sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &none) == 0;
}

} // namespace tactor::rt
