// SPDX-License-Identifier: MIT
#include "fake_line.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactor::test {
namespace {

bool readable(const detail::owned_fd& fd, int timeout_ms)
{
    pollfd p{fd.get(), POLLIN, 0};
    return ::poll(&p, 1, timeout_ms) > 0;
}

std::array<detail::owned_fd, 2> make_pipe()
{
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error("pipe");
    return {detail::owned_fd(ends[0]), detail::owned_fd(ends[1])};
}

} // namespace

std::int64_t now_ns() noexcept
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

fake_line::fake_line()
{
    auto ends = make_pipe();
    read_ = std::move(ends[0]);
    state_.fd = std::move(ends[1]);
}

amplifier::held_line fake_line::held()
{
    return {&set, &state_, {state_.fd.get()}};
}

bool fake_line::set(void* line, bool on) noexcept
{
    state& s = *static_cast<state*>(line);
    if (on && s.broken)
        return false;
    if (!on && s.refusals > 0) {
        --s.refusals;
        return false;
    }
    const switched record{on, now_ns()};
    return ::write(s.fd.get(), &record, sizeof record) == static_cast<ssize_t>(sizeof record);
}

std::optional<switched> fake_line::next(int timeout_ms) const
{
    switched s;
    if (!readable(read_, timeout_ms) || ::read(read_.get(), &s, sizeof s) != static_cast<ssize_t>(sizeof s))
        return std::nullopt;
    return s;
}

player::player(fake_line& line, const amplifier::holder_limits& limits, const body& b,
               const std::function<void()>& before)
{
    auto ends = make_pipe();
    const auto tell = [&](int n) {
        if (::write(ends[1].get(), &n, sizeof n) != static_cast<ssize_t>(sizeof n))
            ::_exit(9);
    };
    pid_ = ::fork();
    if (pid_ == 0)
        [&]() noexcept { // nothing may escape into the test's loop
            die_quietly();
            before();
            auto h = amplifier::start_holder(
                line.held(), [] { return true; }, limits);
            tell(h->pid());
            if (h->set(true))
                b(*h, tell);
            ::_exit(0); // like abort(): the link's destructor does not run
        }();
    ends[1].close();
    told_ = std::move(ends[0]);
    holder_ = told();
    const auto s = line.next();
    if (holder_ <= 0 || !s || !s->on)
        throw std::runtime_error("the player did not switch on");
}

player::~player()
{
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
}

int player::told() const
{
    int n = -1;
    if (!readable(told_, hangs_ms) || ::read(told_.get(), &n, sizeof n) != static_cast<ssize_t>(sizeof n))
        return -1;
    return n;
}

std::int64_t player::signal(int number) const
{
    const std::int64_t t = now_ns();
    ::kill(pid_, number);
    return t;
}

void keep_beating(amplifier::holder_link& h, const std::function<void(int)>&)
{
    for (;;) {
        ::poll(nullptr, 0, 50);
        h.beat();
    }
}

void die_quietly()
{
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    for (int s = 1; s < SIGRTMIN; ++s)
        ::signal(s, SIG_DFL);
}

std::int64_t promised_ms(pid_t holder)
{
    return ::sched_getscheduler(holder) == SCHED_FIFO ? 200 : 1000;
}

detail::owned_fd open_pidfd(pid_t pid)
{
    return detail::owned_fd(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0U)));
}

bool ends(const detail::owned_fd& pidfd)
{
    return readable(pidfd, hangs_ms);
}

std::string read_status(pid_t pid, const std::string& field)
{
    std::ifstream in("/proc/" + std::to_string(pid) + "/status");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(field + ":"))
            return line.substr(line.find_first_not_of(" \t", field.size() + 1));
    return {};
}

} // namespace tactor::test
