// SPDX-License-Identifier: MIT
#include "sink/pacer.hpp"

#include <cerrno>
#include <system_error>

#include <sys/timerfd.h>

namespace tactor::detail {
namespace {

constexpr std::uint64_t second = 1'000'000'000;

} // namespace

pacer::pacer(unsigned rate, unsigned buffer_frames, unsigned period_frames)
    : virtual_queue(rate, buffer_frames),
      period_(period_frames),
      fd_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC))
{
    if (!fd_)
        throw std::system_error(errno, std::generic_category(), "timerfd");
}

void pacer::start(std::uint64_t written) noexcept
{
    virtual_queue::start(rt::monotonic_ns(), written);
}

void pacer::arm() noexcept
{
    const std::int64_t t = time_of_room(period_);
    itimerspec when{};
    when.it_value = rt::to_timespec(t);
    // This also clears expirations, so nobody needs to read them.
    ::timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &when, nullptr);
}

// Rounds up, so that `frames` frames have left at that time. Computes whole seconds apart, so that years fit.
std::int64_t virtual_queue::duration(std::uint64_t frames) const noexcept
{
    const std::uint64_t rest = frames % rate_;
    return static_cast<std::int64_t>(frames / rate_ * second + (rest * second + rate_ - 1) / rate_);
}

void virtual_queue::start(std::int64_t now, std::uint64_t written) noexcept
{
    origin_ = now;
    written_ = written;
}

std::uint64_t virtual_queue::played(std::int64_t now) noexcept
{
    const auto t = static_cast<std::uint64_t>(now - origin_);
    const std::uint64_t due = t / second * rate_ + t % second * rate_ / second;
    if (due <= written_)
        return due;
    origin_ = now - duration(written_);
    return written_;
}

std::uint64_t virtual_queue::available(std::int64_t now) noexcept
{
    const std::uint64_t queued = written_ - played(now);
    return queued < buffer_ ? buffer_ - queued : 0;
}

std::int64_t virtual_queue::time_of_room(std::uint64_t frames) const noexcept
{
    const std::uint64_t must_have_left = written_ + frames > buffer_ ? written_ + frames - buffer_ : 0;
    return origin_ + duration(must_have_left);
}

} // namespace tactor::detail
