// SPDX-License-Identifier: MIT
#include "session/process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>
#include <tactor/tactor.hpp>

#include "core/owned.hpp"
#include "files/text_file.hpp"
#include "rt/thread.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

volatile std::sig_atomic_t ending_signal = 0;

// Ends the process from a signal's handler, so it only makes system calls.
extern "C" void force_exit(int)
{
    constexpr char text[] = "tactor: the device does not answer: ended anyway\n";
    static_cast<void>(!write(STDERR_FILENO, text, sizeof text - 1));
    _exit(interrupt::status(ending_signal));
}

// Reserve for stacks of threads and later allocations. With MCL_FUTURE all memory counts, and allocations
// beyond the limit fail.
constexpr std::uint64_t reserve_bytes = 32U << 20;

/// Returns true for memory in which the audio thread runs. `self` is the program's own file, which contains
/// the library. Other libraries need only pages in use, which are locked when they are loaded.
bool is_audio_memory(std::string_view mapped, std::string_view self)
{
    if (mapped.empty() || mapped == "[heap]" || mapped == "[stack]" || mapped == self)
        return true;
    const std::string_view file = mapped.substr(mapped.rfind('/') + 1);
    constexpr std::string_view names[] = {"libasound", "ld-linux"};
    return std::any_of(std::begin(names), std::end(names),
                       [file](std::string_view name) { return file.starts_with(name); });
}

/// Loads the mapped pages now, so that the audio thread has no page faults.
void load_mapped_pages()
{
    std::error_code none;
    const std::string self = std::filesystem::read_symlink("/proc/self/exe", none).string();
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        std::istringstream in(line);
        std::uintptr_t from = 0;
        std::uintptr_t to = 0;
        char dash = 0;
        std::string rights, offset, device, inode, mapped;
        in >> std::hex >> from >> dash >> to >> rights >> offset >> device >> inode >> mapped;
        if (rights.starts_with('r') && is_audio_memory(mapped, self))
            // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel writes addresses as numbers
            mlock(reinterpret_cast<void*>(from), to - from);
    }
}

/// Locks all memory. Returns the reason of a failure, else an empty string.
std::string lock_own_memory()
{
    if (const auto most = probe_realtime_rights().lockable_bytes) {
        const std::uint64_t wanted = memory_to_lock();
        if (wanted > *most)
            return fmt::format("{} MiB are needed, including a reserve of {}, but {} MiB are allowed",
                               (wanted + (1U << 20) - 1) >> 20, reserve_bytes >> 20, *most >> 20);
    }
    // Keeps one heap that never shrinks, so that memory stays locked, and no arenas of 64 MiB each count for
    // RLIMIT_MEMLOCK.
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_ARENA_MAX, 1);
    if (mlockall(MCL_CURRENT | MCL_ONFAULT) != 0 || mlockall(MCL_FUTURE) != 0)
        return std::strerror(errno);
    load_mapped_pages();
    return "";
}

void limit_runaway_threads()
{
    constexpr rlim_t soft_us = 200'000; // SIGXCPU
    constexpr rlim_t hard_us = 1'000'000;
    rlimit l{};
    if (getrlimit(RLIMIT_RTTIME, &l) != 0)
        return;
    // Keeps stricter limits. The amplifier's holder outlives either signal.
    l.rlim_max = std::min(l.rlim_max, hard_us);
    l.rlim_cur = std::min({l.rlim_cur, soft_us, l.rlim_max});
    setrlimit(RLIMIT_RTTIME, &l);
}

namespace fs = std::filesystem;

// Returns true for a named pipe. A pipe of the shell, <(...) or /dev/stdin, already has its other end.
bool is_named_pipe(const std::string& file)
{
    std::error_code ignored;
    return fs::is_fifo(fs::symlink_status(file, ignored));
}

// Refuses a folder, which has no text, and a terminal or a pipe to which this process writes, because reading
// would never end.
void refuse_unreadable(const std::string& file)
{
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0)
        return;
    if (S_ISDIR(s.st_mode))
        throw error(error_kind::bad_input, source_place{file}, "it is a folder", "name a file in it")
            .with_os_code(EISDIR);
    if (S_ISFIFO(s.st_mode) &&
        (detail::refers_to_file(STDOUT_FILENO, s) || detail::refers_to_file(STDERR_FILENO, s)))
        throw error(error_kind::bad_input, file, "it is the output of this program",
                    "name a file to read, or - for standard input");
    if (!S_ISCHR(s.st_mode))
        return;
    const detail::owned_fd fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (fd && ::isatty(fd.get()) == 1)
        throw error(error_kind::bad_input, file, "it is a terminal", "name a file to read");
}

} // namespace

interrupt::interrupt(unsigned grace_s) : grace_s_(grace_s)
{
    sigset_t set;
    sigemptyset(&set);
    for (int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
        sigaddset(&set, s);
    pthread_sigmask(SIG_BLOCK, &set, &before_);
    fd_ = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    if (fd_ < 0)
        throw error(error_kind::runtime, "signals", std::generic_category().message(errno));
}

interrupt::~interrupt()
{
    alarm(0);
    ending_signal = 0;
    close(fd_);
    if (!last_)
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

int interrupt::poll() noexcept
{
    signalfd_siginfo info{};
    if (read(fd_, &info, sizeof info) != sizeof info)
        return 0;
    const auto signal = static_cast<int>(info.ssi_signo);
    if (ending_signal == 0 && std::signal(SIGALRM, force_exit) != SIG_ERR) {
        ending_signal = signal;
        alarm(grace_s_);
    }
    return signal;
}

std::uint64_t memory_to_lock()
{
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + reserve_bytes;
}

bool prepare_realtime(bool required)
{
    limit_runaway_threads();
    const std::string refused = lock_own_memory();
    if (!refused.empty() && required)
        throw error(error_kind::not_available, "locked memory", refused,
                    rt::realtime_hint(probe_realtime_rights(), player_options{}.priority));
    return refused.empty();
}

void enable_memory_return()
{
    constexpr int large = 128 << 10;
    constexpr int most_at_end = 1 << 20;
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_MAX, 1 << 16);
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, most_at_end);
}

void warn_of_missing_rights(bool realtime, bool locked)
{
    if (realtime && locked)
        return;
    say(stderr,
        "tactor: warning: {}{}{}: xruns are more likely (run tactor check, which says what to change, "
        "such as rtprio and memlock in limits.d, and group audio)\n",
        realtime ? "" : "no real-time priority", realtime || locked ? "" : ", ",
        locked ? "" : "memory is not locked");
}

void check_readable(const std::string& file)
{
    refuse_unreadable(file);
    if (is_named_pipe(file))
        say(stderr, "tactor: {}: it is a pipe: waiting for a program that writes to it (Ctrl-C ends)\n",
            file);
}

bool is_standard_output(const std::string& file)
{
    struct stat s {};
    return ::stat(file.c_str(), &s) == 0 && detail::refers_to_file(STDOUT_FILENO, s);
}

void refuse_standard_input(int code)
{
    const bool wrong = code == EBADF || code == EISDIR;
    throw error(wrong ? error_kind::bad_input : error_kind::runtime, "standard input",
                std::generic_category().message(code), "give lines from a terminal, a file or a pipe")
        .with_os_code(code);
}

void check_standard_input()
{
    char none = 0;
    if (::read(STDIN_FILENO, &none, 0) < 0)
        refuse_standard_input(errno);
}

void report_pipe_wait(const std::string& file)
{
    if (is_named_pipe(file))
        say(stderr, "tactor: {}: it is a pipe: waiting for a program that reads it (Ctrl-C ends)\n", file);
}

} // namespace tactor::session
