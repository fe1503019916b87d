// SPDX-License-Identifier: MIT
#include "amplifier/holder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "rt/clock.hpp"

namespace tactor::amplifier {
namespace {

int open_pidfd(pid_t pid) noexcept
{
    return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0U)); // Linux 5.3
}

void close_if_open(int fd) noexcept
{
    if (fd >= 0)
        ::close(fd);
}

/// Returns true if one of the events came in time.
bool wait_for(int fd, short events, int timeout_ms) noexcept
{
    const std::int64_t until = rt::monotonic_ms() + timeout_ms;
    for (;;) {
        pollfd p{fd, events, 0};
        const std::int64_t left = std::max<std::int64_t>(until - rt::monotonic_ms(), 0);
        const int n = ::poll(&p, 1, static_cast<int>(left));
        if (n >= 0 || errno != EINTR)
            return n > 0;
    }
}

class descriptor {
public:
    explicit descriptor(int fd) : fd_(fd) {}
    ~descriptor() { close_if_open(fd_); }
    descriptor(const descriptor&) = delete;
    descriptor& operator=(const descriptor&) = delete;
    int get() const noexcept { return fd_; }
    int release() noexcept { return std::exchange(fd_, -1); }
    void reset() noexcept { close_if_open(release()); }

private:
    int fd_;
};

[[noreturn]] void fail(const char* step, int code)
{
    detail::throw_caused(error(error_kind::not_available, "amplifier",
                               fmt::format("the process that holds its line did not start: {}: {}", step,
                                           std::generic_category().message(code)),
                               "the limit on processes or descriptors may be reached: ulimit -u, ulimit -n"),
                         code);
}

/// Blocks all signals. In the holder they stay blocked for good, because the player's handlers must not run
/// there.
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

/// Returns the errno of forking, or 0. Returns in the player only.
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

holder_link::holder_link(int socket, std::int32_t pid, std::function<bool()> rescue,
                         const holder_limits& limits)
    : socket_(socket), pid_(pid), process_(open_pidfd(pid)), rescue_(std::move(rescue)), limits_(limits)
{
}

holder_link::~holder_link()
{
    // Waits for the answer, because a holder that is killed now looks like one that has switched off.
    if (on_)
        set(false);
    if (!gone_) {
        ::shutdown(socket_, SHUT_WR);
        if (!wait_for(socket_, 0, limits_.answer_ms)) // the holder closes its side
            give_up();
    }
    close_if_open(process_);
    close_if_open(socket_);
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
        rescued_ = switch_off_here();
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
    if (::send(socket_, &m, sizeof m, MSG_NOSIGNAL | MSG_DONTWAIT) != static_cast<ssize_t>(sizeof m)) {
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
        const std::int64_t left = until - rt::monotonic_ms();
        if (!gone_ && (left <= 0 || !wait_for(socket_, POLLIN, static_cast<int>(left))))
            give_up();
    }
    return false;
}

/// Returns the next message of the holder, if any.
std::optional<message> holder_link::receive() noexcept
{
    message m;
    for (;;) {
        const ssize_t n = ::recv(socket_, &m, sizeof m, MSG_DONTWAIT);
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

/// Kills a holder that is lost or hangs with the line, takes the line over and switches it off.
void holder_link::give_up() noexcept
{
    gone_ = true;
    if (process_ >= 0) {
        ::syscall(SYS_pidfd_send_signal, process_, SIGKILL, nullptr, 0U);
        wait_for(process_, POLLIN, limits_.answer_ms);
    }
    rescued_ = switch_off_here();
}

bool holder_link::switch_off_here() noexcept
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
    descriptor ours(ends[0]);
    descriptor theirs(ends[1]);
    const descriptor player(open_pidfd(::getpid()));

    holder_job job{line.set, line.line, theirs.get(), player.get(), ours.get(), nullptr, 0, limits};
    std::vector<int> keep = kept_descriptors(line, job);
    job.keep = keep.empty() ? nullptr : keep.data();
    job.keep_count = static_cast<unsigned>(keep.size());
    if (const int code = fork_holder(job); code != 0)
        fail("fork", code);
    theirs.reset();

    message hello;
    if (!wait_for(ours.get(), POLLIN, limits.start_ms) ||
        ::recv(ours.get(), &hello, sizeof hello, MSG_DONTWAIT) != static_cast<ssize_t>(sizeof hello))
        fail("no greeting", ETIMEDOUT);
    return std::make_unique<holder_link>(ours.release(), hello.pid, std::move(rescue), limits);
}

} // namespace tactor::amplifier
