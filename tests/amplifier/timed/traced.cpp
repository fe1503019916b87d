// SPDX-License-Identifier: MIT
#include "traced.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <stdexcept>

#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fake_line.hpp"

namespace tactor::test {
namespace {

constexpr long options = PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                         PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL;

long trace(__ptrace_request what, pid_t pid, long data = 0)
{
    // NOLINTNEXTLINE(performance-no-int-to-ptr): that is how ptrace() takes numbers
    return ::ptrace(what, pid, nullptr, reinterpret_cast<void*>(data));
}

// Returns the signal that a stop delivers; 0 for stops of ptrace itself.
int delivered(int status)
{
    const bool own =
        (status >> 16) != 0 || WSTOPSIG(status) == (SIGTRAP | 0x80) || WSTOPSIG(status) == SIGTRAP;
    return own ? 0 : WSTOPSIG(status);
}

int wait_any(pid_t pid, int& status)
{
    for (;;) {
        const pid_t found = ::waitpid(pid, &status, __WALL);
        if (found >= 0 || errno != EINTR)
            return found;
    }
}

// Forks a process that runs the session once it is told to go; a closed `go` ends it.
pid_t start(const std::function<void()>& session, detail::owned_fd& go)
{
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error("pipe");
    const pid_t pid = ::fork();
    if (pid == 0)
        [&]() noexcept {
            die_quietly();
            ::close(ends[1]);
            char c = 0;
            const bool told = ::read(ends[0], &c, 1) == 1;
            ::close(ends[0]);
            if (told)
                session();
            ::_exit(0);
        }();
    ::close(ends[0]);
    go = detail::owned_fd(ends[1]);
    return pid;
}

bool seize(pid_t pid)
{
    int status = 0;
    return trace(PTRACE_SEIZE, pid, options) == 0 && trace(PTRACE_INTERRUPT, pid) == 0 &&
           wait_any(pid, status) == pid && WIFSTOPPED(status);
}

} // namespace

bool can_trace()
{
    detail::owned_fd go;
    const pid_t pid = start([] {}, go);
    bool can = seize(pid);
    if (can) {
        can = trace(PTRACE_SYSCALL, pid) == 0;
        go.close();
        int status = 0;
        __ptrace_syscall_info info{};
        can = can && wait_any(pid, status) == pid && WIFSTOPPED(status) &&
              ::ptrace(PTRACE_GET_SYSCALL_INFO, pid, sizeof info, &info) > 0;
    }
    ::kill(pid, SIGKILL);
    int status = 0;
    while (wait_any(pid, status) == pid && WIFSTOPPED(status)) {
    }
    return can;
}

traced_session::traced_session(const std::function<void()>& session, counts from) : from_(from)
{
    player_ = start(session, go_);
    threads_.insert(player_);
    if (!seize(player_))
        throw std::runtime_error("the player cannot be traced");
    traced_.insert(player_);
    if (::write(go_.get(), "g", 1) != 1 || trace(PTRACE_SYSCALL, player_) != 0)
        throw std::runtime_error("the player does not go");
}

bool traced_session::stopped_at_entry(pid_t pid, int status) const
{
    __ptrace_syscall_info info{};
    return WSTOPSIG(status) == (SIGTRAP | 0x80) &&
           ::ptrace(PTRACE_GET_SYSCALL_INFO, pid, sizeof info, &info) > 0 &&
           info.op == PTRACE_SYSCALL_INFO_ENTRY;
}

// The first child of the player forks the holder.
void traced_session::note_child(pid_t parent, int event)
{
    unsigned long child = 0;
    if (::ptrace(PTRACE_GETEVENTMSG, parent, nullptr, &child) != 0)
        return;
    const auto pid = static_cast<pid_t>(child);
    traced_.insert(pid);
    if (event == PTRACE_EVENT_CLONE) {
        if (threads_.contains(parent))
            threads_.insert(pid);
        return;
    }
    if (threads_.contains(parent) && between_ < 0)
        between_ = pid;
    else if (parent == between_ && holder_ < 0) {
        holder_ = pid;
        holder_fd_ = open_pidfd(pid);
    }
}

bool traced_session::belongs_to(party who, pid_t pid) const
{
    if (who == party::holder)
        return pid == holder_;
    return threads_.contains(pid) && (from_ == counts::all || holder_ >= 0);
}

killed traced_session::kill_at(party counted, unsigned nth, party victim, const std::function<void()>& before)
{
    killed k;
    unsigned calls = 0;
    while (!traced_.empty()) {
        int status = 0;
        const pid_t pid = wait_any(-1, status);
        if (pid < 0)
            break;
        if (!WIFSTOPPED(status)) {
            traced_.erase(pid);
            continue;
        }
        if (const int event = status >> 16;
            event == PTRACE_EVENT_FORK || event == PTRACE_EVENT_VFORK || event == PTRACE_EVENT_CLONE)
            note_child(pid, event);
        if (belongs_to(counted, pid) && stopped_at_entry(pid, status) && calls++ == nth) {
            k.reached = true;
            before();
            strike(victim, k);
            let_go(pid);
            break;
        }
        trace(PTRACE_SYSCALL, pid, delivered(status));
    }
    wait_for_all();
    return k;
}

void traced_session::strike(party victim, killed& k)
{
    k.time_ns = now_ns();
    if (victim != party::holder && traced_.contains(player_))
        k.anybody = ::kill(player_, SIGKILL) == 0;
    if (victim != party::player && traced_.contains(holder_))
        k.anybody = ::kill(holder_, SIGKILL) == 0;
}

// Survivors go on untraced. (A killed one does not stop any more.)
void traced_session::let_go(pid_t stopped)
{
    if (trace(PTRACE_DETACH, stopped) == 0)
        traced_.erase(stopped);
    for (const pid_t p : traced_)
        trace(PTRACE_INTERRUPT, p);
    bool waits = traced_.contains(player_);
    while (!traced_.empty()) {
        int status = 0;
        const pid_t pid = wait_any(-1, status);
        if (pid < 0)
            break;
        if (WIFSTOPPED(status)) {
            if ((status >> 16) == PTRACE_EVENT_FORK || (status >> 16) == PTRACE_EVENT_CLONE)
                note_child(pid, status >> 16);
            if (trace(PTRACE_DETACH, pid, delivered(status)) != 0)
                continue; // killed meanwhile
            traced_.erase(pid);
            continue;
        }
        traced_.erase(pid);
        waits = waits && pid != player_;
    }
}

// The player is our child; the holder is not.
void traced_session::wait_for_all()
{
    int status = 0;
    while (wait_any(player_, status) == player_ && WIFSTOPPED(status)) {
    }
    if (holder_fd_ && !ends(holder_fd_))
        throw std::runtime_error("the holder does not end");
}

} // namespace tactor::test
