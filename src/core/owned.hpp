// SPDX-License-Identifier: MIT
/// \file
/// Owners of resources from C libraries and the system.
#pragma once

#include <utility>

#include <sys/file.h>
#include <unistd.h>

namespace tactor::detail {

/// Deleter for std::unique_ptr<T, deleter<function>>.
template <auto Free>
struct deleter {
    template <typename T>
    void operator()(T* p) const noexcept
    {
        Free(p);
    }
};

/// A descriptor that the destructor closes.
class owned_fd {
public:
    owned_fd() noexcept = default;
    /// Takes over `fd`. A negative `fd`, the result of a failed system call, makes the object empty.
    explicit owned_fd(int fd) noexcept : fd_(fd) {}
    owned_fd(owned_fd&& o) noexcept : fd_(o.release()) {}
    owned_fd& operator=(owned_fd&& o) noexcept
    {
        std::swap(fd_, o.fd_);
        return *this;
    }
    ~owned_fd() { close(); }

    int get() const noexcept { return fd_; }
    int release() noexcept { return std::exchange(fd_, -1); }
    /// Closes the descriptor. Returns the result of close(2), or 0 if the object is empty.
    int close() noexcept { return fd_ >= 0 ? ::close(release()) : 0; }
    explicit operator bool() const noexcept { return fd_ >= 0; }

private:
    int fd_ = -1;
};

/// Locks a file or a folder against other processes. If another process holds the lock, tries again every 5
/// ms. Returns false after `tries` attempts.
inline bool lock_file(const owned_fd& file, int tries) noexcept
{
    constexpr useconds_t pause_us = 5000;
    for (int i = 0; ::flock(file.get(), LOCK_EX | LOCK_NB) != 0; ++i) {
        if (i == tries)
            return false;
        ::usleep(pause_us);
    }
    return true;
}

} // namespace tactor::detail
