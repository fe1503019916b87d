// SPDX-License-Identifier: MIT
/// \file
/// Real-time pace for devices without a clock: null, file over null, and plugins on them.
#pragma once

#include <cstdint>

#include "core/owned.hpp"
#include "rt/clock.hpp"

namespace tactor::detail {

/// Queue of a device without a clock. Frames leave at the sample rate. Pure arithmetic: the caller passes the
/// time. Deadlines count from one origin, so they do not drift. If the writer is late, the origin moves, so
/// the clock waits for the writer: without a DAC nothing is lost. All times are CLOCK_MONOTONIC, ns.
class virtual_queue {
public:
    virtual_queue(unsigned rate, unsigned buffer_frames) noexcept : rate_(rate), buffer_(buffer_frames) {}

    /// Starts the queue: frame 0 leaves at `now`.
    void start(std::int64_t now, std::uint64_t written) noexcept;
    void wrote(std::uint64_t frames) noexcept { written_ += frames; }

    /// Returns the number of frames that have left.
    std::uint64_t played(std::int64_t now) noexcept;
    /// Returns the number of frames that fit.
    std::uint64_t available(std::int64_t now) noexcept;
    /// Returns the first time at which `frames` frames fit (frames <= the buffer).
    std::int64_t room_time_ns(std::uint64_t frames) const noexcept;

private:
    std::int64_t duration(std::uint64_t frames) const noexcept;

    std::uint64_t rate_;
    std::uint64_t buffer_;
    std::uint64_t written_ = 0;
    std::int64_t origin_ = 0;
};

/// A virtual queue and a timerfd that is readable when a period fits into it.
class pacer : public virtual_queue {
public:
    /// \throws std::system_error when no timer can be created.
    pacer(unsigned rate, unsigned buffer_frames, unsigned period_frames);

    int fd() const noexcept { return fd_.get(); }

    void start(std::uint64_t written) noexcept;
    std::uint64_t available() noexcept { return virtual_queue::available(rt::monotonic_ns()); }

    /// Sets the timer to the time when a period fits. If that time has passed, the timer is readable at once.
    /// The timer stays readable until it is set again.
    void arm() noexcept;
    /// Returns true if a period fits.
    bool due() noexcept { return available() >= period_; }

private:
    unsigned period_;
    owned_fd fd_;
};

} // namespace tactor::detail
