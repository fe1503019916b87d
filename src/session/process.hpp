// SPDX-License-Identifier: MIT
/// \file
/// The process of a command: the signals that end it, its real-time settings and memory, and checks of the
/// files, pipes and standard streams that it reads and writes.
#pragma once

#include <csignal>
#include <cstdint>
#include <string>

namespace tactor::session {

/// Receiver of SIGINT, SIGTERM, SIGHUP and SIGQUIT through a descriptor. It blocks these signals in this
/// thread, and so in all threads that this thread starts. Make it before any thread starts.
class interrupt {
public:
    /// \throws error (runtime).
    explicit interrupt(unsigned grace_s = 20);
    ~interrupt();
    interrupt(const interrupt&) = delete;
    interrupt& operator=(const interrupt&) = delete;

    /// Returns a descriptor that is readable when a signal has come.
    int descriptor() const noexcept { return fd_; }
    /// Returns the signal that has come, or 0. Does not wait. After the first signal the program has
    /// `grace_s` to end by itself. Then the process ends with the status for that signal, because the library
    /// that drives a device may hang for ever. The amplifier's holder switches off when the program is gone.
    int poll() noexcept;
    /// Ignores all further signals: this process is already ending.
    void ignore_further_signals() noexcept { last_ = true; }
    /// Returns the exit status for a signal: 128 + its number.
    static int status(int signal) noexcept { return 128 + signal; }

private:
    int fd_;
    unsigned grace_s_;
    bool last_ = false;
    sigset_t before_{};
};

/// Locks all present and future memory of the process. Lets the kernel end the process if a real-time thread
/// runs for 0.2 s without a pause, because such a thread would block a computer with one core for ever. Call
/// it after the last fork and before threads start. Returns true if memory is locked.
/// \throws error (not_available) if memory cannot be locked although it is `required`.
bool prepare_realtime(bool required);

/// Returns the number of bytes that prepare_realtime() would lock now, including those for threads.
std::uint64_t memory_to_lock();

/// Lets the heap return freed memory to the system: large blocks are mapped one by one. For a long-lived
/// process whose clients come and go. Call it after prepare_realtime(), which keeps all memory.
void enable_memory_return();

/// Warns on standard error if the audio thread has no real-time priority or its memory is not locked.
void warn_of_missing_rights(bool realtime, bool locked);

/// Checks a file before it is read. Prints on standard error that the tool waits if the file is a named pipe.
/// \throws error (bad_input) for a folder, a terminal, and a pipe or file that this program itself writes to.
void check_readable(const std::string& file);

/// Returns true if a name means this process's standard output (/dev/stdout, /dev/fd/1).
bool is_standard_output(const std::string& file);

/// Throws the error for standard input that cannot be read. `code`: errno.
/// \throws error: bad_input if it is closed or a folder, else runtime.
[[noreturn]] void refuse_standard_input(int code);

/// Throws error if standard input cannot be read. Call it before any other work.
/// \throws error as refuse_standard_input() does.
void check_standard_input();

/// Prints on standard error that the tool waits for a program that reads a named pipe. Prints nothing for
/// other files.
void report_pipe_wait(const std::string& file);

} // namespace tactor::session
