// SPDX-License-Identifier: MIT
#include "amplifier/holder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <system_error>
#include <utility>

#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "rt/clock.hpp"

namespace tactor::amplifier {
namespace {

// Everything that the holder needs, made before the fork.
struct holder_job {
    bool (*set)(void* line, bool on) noexcept = nullptr; // async-signal-safe
    void* line = nullptr;
    int socket = -1;         // socket to the player
    int player = -1;         // pidfd of the player; -1 if the kernel has no pidfds
    int player_socket = -1;  // the player's end of the socket, to be closed
    int* keep = nullptr;     // descriptors that `set` needs, sorted; null: not known, so close nothing
    unsigned keep_count = 0; // number of elements of `keep`
    holder_limits limits = {};
};

// Priority above the audio threads (65) and the kernel's interrupt threads (50). The holder sleeps except for
// a few ioctls.
constexpr int priority = 80;

// Number of attempts to switch the line off at the end: one second in total.
constexpr int last_tries = 100;
constexpr int last_pause_ms = 10;

// Starts a new session: signals of the terminal and of the player's process group do not reach the holder.
// Signals to the holder alone stay pending, because fork() left every signal blocked.
void detach_from_player() noexcept
{
    ::setsid();
    ::prctl(PR_SET_NAME, "tactor-amp", 0UL, 0UL, 0UL);
    if (::chdir("/") != 0) // only to keep no file system busy
        return;
}

bool set_fifo_priority(int level) noexcept
{
    sched_param p{};
    p.sched_priority = level;
    return ::sched_setscheduler(0, SCHED_FIFO, &p) == 0;
}

// Takes the highest priority that the limits allow, on any processor, whatever settings the player's thread
// has.
void raise_own_priority() noexcept
{
    cpu_set_t all;
    for (std::size_t i = 0; i < CPU_SETSIZE; ++i)
        CPU_SET(i, &all);
    ::sched_setaffinity(0, sizeof all, &all);
    rlimit limit{};
    if (set_fifo_priority(priority))
        return;
    if (::getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 && limit.rlim_cur < priority &&
        set_fifo_priority(static_cast<int>(limit.rlim_cur)))
        return;
    sched_param none{};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
    ::setpriority(PRIO_PROCESS, 0, -10);
}

void close_descriptor_range(unsigned first, unsigned last) noexcept
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

// Closes the player's pipes, devices and other lines, and the player's end of the socket: they must not stay
// open in the holder.
void close_other_descriptors(const holder_job& job) noexcept
{
    ::close(job.player_socket);
    if (!job.keep)
        return;
    unsigned from = 0;
    for (unsigned i = 0; i < job.keep_count; ++i) {
        const unsigned fd = static_cast<unsigned>(job.keep[i]);
        if (fd > from)
            close_descriptor_range(from, fd - 1);
        from = fd + 1;
    }
    close_descriptor_range(from, ~0U);
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
        // Tries again, because no other process can switch the line off.
        for (int tries = 0; !job_.set(job_.line, false) && tries < last_tries; ++tries)
            ::poll(nullptr, 0, last_pause_ms);
    }

private:
    void send(const message& m) noexcept { ::send(job_.socket, &m, sizeof m, MSG_NOSIGNAL | MSG_DONTWAIT); }

    // Returns true when the player has ended. The player's pidfd shows the end even if another child of the
    // player keeps the socket open.
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

    // Obeys the messages that wait. Returns false if nobody is left to send messages.
    bool take_messages() noexcept
    {
        for (;;) {
            message m;
            const ssize_t n = ::recv(job_.socket, &m, sizeof m, MSG_DONTWAIT);
            if (n == static_cast<ssize_t>(sizeof m))
                handle_message(m);
            else if (n >= 0 || (errno != EINTR && errno != EAGAIN))
                return false;
            else if (errno == EAGAIN)
                return true;
        }
    }

    void handle_message(message m) noexcept
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
        heard_ms_ = rt::monotonic_ms(); // after a failure, tries again after the same time
        send({message_kind::lapsed, 0, !on_, 0});
    }

    const holder_job& job_;
    std::int64_t heard_ms_ = 0;
    bool on_ = false;
};

// Runs the holder in the forked process, and ends that process. The player may have threads, so after fork()
// the holder only runs async-signal-safe code: it does not allocate or lock, and all that it needs was made
// before.
[[noreturn]] void run_holder(const holder_job& job) noexcept
{
    detach_from_player();
    close_other_descriptors(job);
    raise_own_priority();
    holder(job).run();
    // Releases the line before the socket closes: the player waits until the socket is closed, and may then
    // request the line again.
    for (unsigned i = 0; i < job.keep_count; ++i)
        if (job.keep[i] != job.socket)
            ::close(job.keep[i]);
    ::_exit(0);
}

int open_pidfd(pid_t pid) noexcept
{
    return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0U)); // Linux 5.3
}

/// Returns true if one of the events came in time.
bool wait_for(int fd, short events, int timeout_ms) noexcept
{
    const std::int64_t until = rt::monotonic_ms() + timeout_ms;
    for (;;) {
        pollfd p{fd, events, 0};
        const std::int64_t rest_ms = std::max<std::int64_t>(until - rt::monotonic_ms(), 0);
        const int n = ::poll(&p, 1, static_cast<int>(rest_ms));
        if (n >= 0 || errno != EINTR)
            return n > 0;
    }
}

[[noreturn]] void fail(const char* step, int code)
{
    detail::throw_with_cause(error(error_kind::not_available, "amplifier",
                                   fmt::format("the process that holds its line did not start: {}: {}", step,
                                               std::generic_category().message(code)),
                                   "check the limits on processes and descriptors: ulimit -u, ulimit -n"),
                             code);
}

/// Scope in which all signals are blocked. In the holder they stay blocked, because the player's handlers
/// must not run there.
class signals_blocked {
public:
    signals_blocked()
    {
        sigset_t all;
        sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~signals_blocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    signals_blocked(const signals_blocked&) = delete;
    signals_blocked& operator=(const signals_blocked&) = delete;

private:
    sigset_t before_{};
};

/// Forks the holder. Returns 0, or the errno of a failure; returns in the player only.
int fork_holder(const holder_job& job) noexcept
{
    const signals_blocked in_this_thread;
    const pid_t between = ::fork();
    if (between < 0)
        return errno;
    if (between == 0) {
        const pid_t holder = ::_Fork(); // async-signal-safe, unlike fork()
        if (holder == 0)
            run_holder(job);
        ::_exit(holder < 0 ? errno : 0);
    }
    int status = 0;
    while (::waitpid(between, &status, 0) < 0)
        if (errno != EINTR)
            return 0; // the host reaps all children itself; the greeting shows success
    return WIFEXITED(status) ? WEXITSTATUS(status) : EIO;
}

std::vector<int> kept_descriptors(const held_line& line, const holder_job& job)
{
    std::vector<int> keep = line.descriptors;
    if (std::find(keep.begin(), keep.end(), -1) != keep.end())
        return {};
    keep.push_back(job.socket);
    if (job.player >= 0)
        keep.push_back(job.player);
    std::sort(keep.begin(), keep.end());
    return keep;
}

} // namespace

holder_link::holder_link(detail::owned_fd socket, std::int32_t pid, std::function<bool()> rescue,
                         const holder_limits& limits)
    : socket_(std::move(socket)),
      pid_(pid),
      process_(open_pidfd(pid)),
      rescue_(std::move(rescue)),
      limits_(limits)
{
}

holder_link::~holder_link()
{
    // Waits for the answer, because a holder that is killed now looks like one that has switched off.
    if (on_)
        set(false);
    if (!gone_) {
        ::shutdown(socket_.get(), SHUT_WR);
        if (!wait_for(socket_.get(), 0, limits_.answer_ms)) // the holder closes its side
            give_up();
    }
}

bool holder_link::set(bool on) noexcept
{
    const message_kind kind = on ? message_kind::on : message_kind::off;
    on_ = true; // unknown until the answer comes
    if (!gone_ && send(kind) && await_answer(kind)) {
        on_ = on;
        return true;
    }
    if (gone_ && !on && !rescued_)
        rescued_ = call_rescue();
    on_ = !(gone_ && rescued_);
    return gone_ && !on && rescued_;
}

bool holder_link::beat() noexcept
{
    while (!gone_ && receive()) {
    }
    if (!gone_ && unanswered_ >= limits_.unanswered)
        give_up();
    return !gone_ && send(message_kind::beat) && !lapsed_;
}

bool holder_link::send(message_kind kind) noexcept
{
    const message m{kind, ++number_, true, 0};
    if (::send(socket_.get(), &m, sizeof m, MSG_NOSIGNAL | MSG_DONTWAIT) != static_cast<ssize_t>(sizeof m)) {
        give_up();
        return false;
    }
    ++unanswered_;
    return true;
}

bool holder_link::await_answer(message_kind kind) noexcept
{
    const std::int64_t until = rt::monotonic_ms() + limits_.answer_ms;
    while (!gone_) {
        while (const auto m = receive()) {
            if (m->kind != kind || m->number != number_)
                continue;
            lapsed_ = lapsed_ && !m->done;
            return m->done;
        }
        const std::int64_t rest_ms = until - rt::monotonic_ms();
        if (!gone_ && (rest_ms <= 0 || !wait_for(socket_.get(), POLLIN, static_cast<int>(rest_ms))))
            give_up();
    }
    return false;
}

/// Returns the next message of the holder, if any.
std::optional<message> holder_link::receive() noexcept
{
    message m;
    for (;;) {
        const ssize_t n = ::recv(socket_.get(), &m, sizeof m, MSG_DONTWAIT);
        if (n == static_cast<ssize_t>(sizeof m))
            break;
        if (n < 0 && errno == EINTR)
            continue;
        if (n >= 0 || errno != EAGAIN)
            give_up();
        return std::nullopt;
    }
    unanswered_ = 0;
    lapsed_ = lapsed_ || m.kind == message_kind::lapsed;
    return m;
}

/// Kills a holder that is lost, or that hangs and keeps the line. Takes the line over and switches it off.
void holder_link::give_up() noexcept
{
    gone_ = true;
    if (process_) {
        ::syscall(SYS_pidfd_send_signal, process_.get(), SIGKILL, nullptr, 0U);
        wait_for(process_.get(), POLLIN, limits_.answer_ms);
    }
    rescued_ = call_rescue();
}

bool holder_link::call_rescue() noexcept
{
    try {
        return rescue_();
    } catch (...) {
        return false;
    }
}

std::unique_ptr<holder_link> start_holder(const held_line& line, std::function<bool()> rescue,
                                          const holder_limits& limits)
{
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        fail("socketpair", errno);
    detail::owned_fd ours(ends[0]);
    detail::owned_fd theirs(ends[1]);
    const detail::owned_fd player(open_pidfd(::getpid()));

    holder_job job{line.set, line.line, theirs.get(), player.get(), ours.get(), nullptr, 0, limits};
    std::vector<int> keep = kept_descriptors(line, job);
    job.keep = keep.empty() ? nullptr : keep.data();
    job.keep_count = static_cast<unsigned>(keep.size());
    if (const int code = fork_holder(job); code != 0)
        fail("fork", code);
    theirs.close();

    message hello;
    if (!wait_for(ours.get(), POLLIN, limits.start_ms) ||
        ::recv(ours.get(), &hello, sizeof hello, MSG_DONTWAIT) != static_cast<ssize_t>(sizeof hello))
        fail("no greeting", ETIMEDOUT);
    return std::make_unique<holder_link>(std::move(ours), hello.pid, std::move(rescue), limits);
}

} // namespace tactor::amplifier
