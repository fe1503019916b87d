// SPDX-License-Identifier: MIT
/// \file
/// Ctrl-C and its kin as a descriptor.
#pragma once

#include <csignal>

namespace tactor::session {

/// Blocks SIGINT, SIGTERM, SIGHUP and SIGQUIT in this thread, and so in those that it starts, and receives
/// them through a descriptor. Make it before any thread.
class interrupt {
public:
    /// \throws error (runtime).
    explicit interrupt(unsigned grace_s = 20);
    ~interrupt();
    interrupt(const interrupt&) = delete;
    interrupt& operator=(const interrupt&) = delete;

    /// Readable when a signal has come.
    int descriptor() const noexcept { return fd_; }
    /// Returns the signal that has come, or 0. Does not wait. From the first signal on the program has
    /// `grace_s` to end by itself: then it is ended with that signal's status, since a device may hang for
    /// good in the library that drives it. The amplifier's holder switches off when the program is gone.
    int poll() noexcept;
    /// Ignores all further signals: this process is already ending.
    void was_the_last() noexcept { last_ = true; }
    /// Returns the exit status for a signal: 128 + its number.
    static int status(int signal) noexcept { return 128 + signal; }

private:
    int fd_;
    unsigned grace_s_;
    bool last_ = false;
    sigset_t before_{};
};

} // namespace tactor::session
