// SPDX-License-Identifier: MIT
/// \file
/// The process of a command: the signals that end it, its real-time settings and memory, and checks of the
/// files, pipes and standard streams that it reads and writes.
#pragma once

#include <csignal>
#include <cstdint>
#include <string>

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

/// Locks all memory of the process, now and to come, and lets the kernel end the process if a real-time
/// thread runs for 0.2 s without a pause: it would block a computer with one core for good. Call it before
/// threads are made and after the last fork. Returns true if memory is locked. \throws error (not_available)
/// if it is not, and `required`.
bool settle_realtime(bool required);

/// Returns how much settle_realtime() would lock now, with what threads will need.
std::uint64_t memory_to_lock();

/// Lets the heap give back what is freed, for a process that lives long and whose clients come and go: large
/// blocks are mapped one by one. Call it after settle_realtime(), which keeps all.
void give_memory_back();

/// Warns on standard error if the audio thread has no real-time priority or its memory is not locked.
void warn_of_rights(bool realtime, bool locked);

/// Says on standard error that the tool waits for a program that writes to a named pipe; call it before a
/// file is read. \throws error (bad_input) for a folder, a terminal, and a pipe or file that this program
/// itself writes to.
void check_readable(const std::string& file);

/// Returns true if a name is one of this process's standard output (/dev/stdout, /dev/fd/1).
bool is_standard_output(const std::string& file);

/// Refuses standard input that cannot be read, for an errno. \throws error: bad_input if it is closed or a
/// folder, else runtime.
[[noreturn]] void refuse_standard_input(int code);

/// Refuses standard input that cannot be read, before anything else is done. \throws error as above.
void check_standard_input();

/// Says on standard error that the tool waits for a program that reads a named pipe. Else nothing.
void tell_of_pipe_to_write(const std::string& file);

} // namespace tactor::session
