// SPDX-License-Identifier: MIT
#include "sink/pacer.hpp"

#include <cerrno>
#include <system_error>

#include <sys/timerfd.h>

namespace tactor::detail {

pacer::pacer(unsigned rate, unsigned buffer_frames, unsigned period_frames)
    : queue_(rate, buffer_frames),
      period_(period_frames),
      fd_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC))
{
    if (!fd_)
        throw std::system_error(errno, std::generic_category(), "timerfd");
}

void pacer::start(std::uint64_t written) noexcept
{
    queue_.start(rt::monotonic_ns(), written);
}

void pacer::arm() noexcept
{
    const std::int64_t t = queue_.time_of_room(period_);
    itimerspec when{};
    when.it_value = rt::to_timespec(t);
    // Forgets expirations, too: nobody needs to read them.
    ::timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &when, nullptr);
}

} // namespace tactor::detail
