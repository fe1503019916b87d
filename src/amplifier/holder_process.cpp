// SPDX-License-Identifier: MIT
#include "amplifier/holder_process.hpp"

#include <cerrno>
#include <cstddef>

#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "rt/clock.hpp"

namespace tactor::amplifier {
namespace {

// Above the audio threads (65) and the kernel's interrupt threads (50). The holder sleeps except for a few
// ioctls.
constexpr int priority = 80;

// Attempts to switch the line off at the end, for a second.
constexpr int last_tries = 100;
constexpr int last_pause_ms = 10;

// Starts a new session: signals of the terminal and of the player's process group do not reach the holder.
// Signals to the holder alone stay pending, because fork() left every signal blocked.
void leave_the_player() noexcept
{
    ::setsid();
    ::prctl(PR_SET_NAME, "tactor-amp", 0UL, 0UL, 0UL);
    if (::chdir("/") != 0) // only to keep no file system busy
        return;
}

bool become_fifo(int level) noexcept
{
    sched_param p{};
    p.sched_priority = level;
    return ::sched_setscheduler(0, SCHED_FIFO, &p) == 0;
}

// Takes a priority as high as the player's may be, on any processor, whatever settings the player's thread
// has.
void become_prompt() noexcept
{
    cpu_set_t all;
    for (std::size_t i = 0; i < CPU_SETSIZE; ++i)
        CPU_SET(i, &all);
    ::sched_setaffinity(0, sizeof all, &all);
    rlimit limit{};
    if (become_fifo(priority))
        return;
    if (::getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 && limit.rlim_cur < priority &&
        become_fifo(static_cast<int>(limit.rlim_cur)))
        return;
    sched_param none{};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
    ::setpriority(PRIO_PROCESS, 0, -10);
}

void close_span(unsigned first, unsigned last) noexcept
{
    if (first > last || ::syscall(SYS_close_range, first, last, 0U) == 0)
        return;
    // close_range is missing (before Linux 5.9) or forbidden.
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    constexpr unsigned bound = 65536;
    const unsigned end = limit.rlim_cur < bound ? static_cast<unsigned>(limit.rlim_cur) : bound;
    for (unsigned fd = first; fd <= last && fd < end; ++fd)
        ::close(static_cast<int>(fd));
}

// Closes the player's pipes, devices and other lines, and its end of the socket: they must not stay open in
// the holder.
void close_others(const holder_job& job) noexcept
{
    ::close(job.player_socket);
    if (!job.keep)
        return;
    unsigned from = 0;
    for (unsigned i = 0; i < job.keep_count; ++i) {
        const unsigned kept = static_cast<unsigned>(job.keep[i]);
        if (kept > from)
            close_span(from, kept - 1);
        from = kept + 1;
    }
    close_span(from, ~0U);
}

class holder {
public:
    explicit holder(const holder_job& job) noexcept : job_(job) {}

    void run() noexcept
    {
        message hello;
        hello.pid = ::getpid();
        send(hello);
        while (!wait() && take_messages())
            check_silence();
        // Tries again, because no other process can.
        for (int tries = 0; !job_.set(job_.line, false) && tries < last_tries; ++tries)
            ::poll(nullptr, 0, last_pause_ms);
    }

private:
    void send(const message& m) noexcept { ::send(job_.socket, &m, sizeof m, MSG_NOSIGNAL | MSG_DONTWAIT); }

    // Returns true when the player has ended. Its pidfd shows this even if another of its children keeps the
    // socket open.
    bool wait() noexcept
    {
        pollfd fds[2] = {{job_.socket, POLLIN, 0}, {job_.player, POLLIN, 0}};
        std::int64_t timeout = -1;
        if (on_) {
            timeout = heard_ms_ + job_.limits.silence_ms - rt::monotonic_ms();
            timeout = timeout < 0 ? 0 : timeout;
        }
        const int n = ::poll(fds, 2, static_cast<int>(timeout));
        return n > 0 && fds[1].revents != 0;
    }

    // Returns false if nobody is left to send messages.
    bool take_messages() noexcept
    {
        for (;;) {
            message m;
            const ssize_t n = ::recv(job_.socket, &m, sizeof m, MSG_DONTWAIT);
            if (n == static_cast<ssize_t>(sizeof m))
                obey(m);
            else if (n >= 0 || (errno != EINTR && errno != EAGAIN))
                return false;
            else if (errno == EAGAIN)
                return true;
        }
    }

    void obey(message m) noexcept
    {
        heard_ms_ = rt::monotonic_ms();
        if (m.kind == message_kind::on || m.kind == message_kind::off) {
            const bool on = m.kind == message_kind::on;
            m.done = job_.set(job_.line, on);
            on_ = m.done ? on : on_ || on;
        }
        send(m);
    }

    void check_silence() noexcept
    {
        if (!on_ || rt::monotonic_ms() - heard_ms_ < job_.limits.silence_ms)
            return;
        on_ = !job_.set(job_.line, false);
        heard_ms_ = rt::monotonic_ms(); // after a failure it waits the same time again
        send({message_kind::lapsed, 0, !on_, 0});
    }

    const holder_job& job_;
    std::int64_t heard_ms_ = 0;
    bool on_ = false;
};

} // namespace

void run_holder(const holder_job& job) noexcept
{
    leave_the_player();
    close_others(job);
    become_prompt();
    holder(job).run();
    // Releases the line before the socket closes, because the player waits for that and may then request the
    // line again.
    for (unsigned i = 0; i < job.keep_count; ++i)
        if (job.keep[i] != job.socket)
            ::close(job.keep[i]);
    ::_exit(0);
}

} // namespace tactor::amplifier
