// SPDX-License-Identifier: MIT
/// \file
/// Owners of what C libraries and the system hand out.
#pragma once

#include <utility>

#include <sys/file.h>
#include <unistd.h>

namespace tactor::detail {

/// For std::unique_ptr<T, deleter<function>>.
template <auto Free>
struct deleter {
    template <typename T>
    void operator()(T* p) const noexcept
    {
        Free(p);
    }
};

/// A descriptor that is closed with this.
class owned_fd {
public:
    owned_fd() noexcept = default;
    /// Takes it over; one below 0, which a call of the system gave with an errno, is none.
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
    /// What close(2) gives; 0 where there is none.
    int close() noexcept { return fd_ >= 0 ? ::close(release()) : 0; }
    explicit operator bool() const noexcept { return fd_ >= 0; }

private:
    int fd_ = -1;
};

/// Locks a folder against others and waits for them, 5 ms at a time. Goes on without the lock where somebody
/// holds it for longer: that one is at fault.
inline void lock_folder(const owned_fd& folder, int tries) noexcept
{
    constexpr useconds_t pause_us = 5000;
    for (int i = 0; ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && i < tries; ++i)
        ::usleep(pause_us);
}

} // namespace tactor::detail
