// SPDX-License-Identifier: MIT
/// \file
/// Real time for devices without a clock: null, file over null, and what is built on them.
#pragma once

#include <cstdint>

#include "core/owned.hpp"
#include "rt/clock.hpp"
#include "sink/virtual_queue.hpp"

namespace tactor::detail {

/// A virtual queue and a timerfd that is readable when a period fits into it.
class pacer {
public:
    /// \throws std::system_error when no timer can be created.
    pacer(unsigned rate, unsigned buffer_frames, unsigned period_frames);

    int fd() const noexcept { return fd_.get(); }

    void start(std::uint64_t written) noexcept;
    void wrote(std::uint64_t frames) noexcept { queue_.wrote(frames); }
    std::uint64_t played(std::int64_t now) noexcept { return queue_.played(now); }
    std::uint64_t available() noexcept { return queue_.available(rt::monotonic_ns()); }

    /// Sets the timer to when a period fits; a time in the past makes it readable at once. It stays readable
    /// until it is set again.
    void arm() noexcept;
    /// Whether a period fits.
    bool due() noexcept { return available() >= period_; }

private:
    virtual_queue queue_;
    unsigned period_;
    owned_fd fd_;
};

} // namespace tactor::detail
