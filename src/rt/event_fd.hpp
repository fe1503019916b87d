// SPDX-License-Identifier: MIT
/// \file
/// An eventfd, which wakes a thread that polls.
#pragma once

#include <cerrno>
#include <cstdint>
#include <system_error>

#include <sys/eventfd.h>
#include <unistd.h>

#include "rt/nonblocking.hpp"

namespace tactor::rt {

class event_fd {
public:
    /// \throws std::system_error when the process has no descriptors left.
    event_fd() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC))
    {
        if (fd_ < 0)
            throw std::system_error(errno, std::generic_category(), "eventfd");
    }
    ~event_fd() { ::close(fd_); }
    event_fd(const event_fd&) = delete;
    event_fd& operator=(const event_fd&) = delete;

    int fd() const noexcept { return fd_; }

    /// Makes the descriptor readable. Any thread; does not block.
    void signal() noexcept
    {
        const permitted_call here{};
        const std::uint64_t one = 1;
        // EAGAIN means that 2^64 - 2 signals wait, so the descriptor is readable anyway.
        while (::write(fd_, &one, sizeof one) < 0 && errno == EINTR) {
        }
    }

    /// Consumes all signals and returns their number. Does not block.
    std::uint64_t consume() noexcept
    {
        std::uint64_t n = 0;
        while (::read(fd_, &n, sizeof n) < 0)
            if (errno != EINTR)
                return 0;
        return n;
    }

private:
    int fd_;
};

} // namespace tactor::rt
