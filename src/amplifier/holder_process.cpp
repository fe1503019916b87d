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

namespace tactor::gpio {
namespace {

// Above the audio threads (65) and the kernel's interrupt threads (50): it sleeps but for its few ioctls.
constexpr int priority = 80;

// A line that refuses to go off at the end is tried again for a second.
constexpr int last_tries = 100;
constexpr int last_pause_ms = 10;

// Its own session: neither the terminal's signals nor those to the player's process group reach it. What
// is sent to it alone waits forever, for fork() left every signal blocked.
void leave_the_player() noexcept
{
    ::setsid();
    ::prctl(PR_SET_NAME, "tactor-amp", 0UL, 0UL, 0UL);
    if (::chdir("/") != 0) // only so that no file system is kept busy
        return;
}

bool become_fifo(int level) noexcept
{
    sched_param p{};
    p.sched_priority = level;
    return ::sched_setscheduler(0, SCHED_FIFO, &p) == 0;
}

// As prompt as the player may be, on any processor, whatever the player's thread had been given.
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
    // Before Linux 5.9, or forbidden.
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    constexpr unsigned bound = 65536;
    const unsigned end = limit.rlim_cur < bound ? static_cast<unsigned>(limit.rlim_cur) : bound;
    for (unsigned fd = first; fd <= last && fd < end; ++fd)
        ::close(static_cast<int>(fd));
}

// The player's pipes, devices and other lines must not stay open with us, nor its end of our socket.
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
        // Nobody is left who could try again.
        for (int tries = 0; !job_.set(job_.line, false) && tries < last_tries; ++tries)
            ::poll(nullptr, 0, last_pause_ms);
    }

private:
    void send(const message& m) noexcept { ::send(job_.socket, &m, sizeof m, MSG_NOSIGNAL | MSG_DONTWAIT); }

    // Whether the player has ended. Its pidfd says so even while another process it started keeps our
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

    // False when there is nobody left to send any.
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
        heard_ms_ = rt::monotonic_ms(); // when it failed: again after the same time
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
    // The line is free before the player, which waits for the socket's end, can ask for it again.
    for (unsigned i = 0; i < job.keep_count; ++i)
        if (job.keep[i] != job.socket)
            ::close(job.keep[i]);
    ::_exit(0);
}

} // namespace tactor::gpio
