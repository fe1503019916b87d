// SPDX-License-Identifier: MIT
// The holder in the life of a player: commands, beats, inherited resources, its own loss, and each end of the
// player. Its latency: timed/.
#include "amplifier/holder.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "fake_line.hpp"

namespace holder_test {

using namespace tactor;
using namespace tactor::test;

namespace {

bool never()
{
    return false;
}

std::unique_ptr<amplifier::holder_link> start(fake_line& line, std::function<bool()> rescue = never,
                                              const amplifier::holder_limits& limits = patient)
{
    return amplifier::start_holder(line.held(), std::move(rescue), limits);
}

std::string next_record(const fake_line& line)
{
    const auto s = line.next();
    return s ? (s->on ? "on" : "off") : "nothing";
}

// Negative where there are none.
int new_terminal()
{
    const int fd = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (fd >= 0 && ::grantpt(fd) == 0 && ::unlockpt(fd) == 0)
        return fd;
    ::close(fd);
    return -1;
}

bool no_terminals()
{
    const int fd = new_terminal();
    if (fd < 0)
        std::printf("SKIPPED: a terminal that is closed leaves the line off: no pseudo-terminals here\n");
    else
        ::close(fd);
    return fd < 0;
}

} // namespace

TEST_CASE("the line follows the commands and ends off, and the holder ends with the link")
{
    fake_line line;
    auto h = start(line);
    const detail::owned_fd holder = open_pidfd(h->pid());
    CHECK(!line.next(0).has_value());
    CHECK(h->set(true));
    CHECK(next_record(line) == "on");
    CHECK(h->set(false));
    CHECK(next_record(line) == "off");
    CHECK(h->set(true));
    CHECK(next_record(line) == "on");
    h.reset();
    CHECK(next_record(line) == "off");
    CHECK(ends(holder));
}

TEST_CASE("a line goes off when its player is silent, which notices and may switch on again")
{
    fake_line line;
    amplifier::holder_limits limits = patient;
    limits.silence_ms = 100;
    const auto h = start(line, never, limits);
    CHECK(h->beat());
    for (int i = 0; i < 3; ++i) {
        const std::int64_t before = now_ns();
        CHECK(h->set(true));
        CHECK(next_record(line) == "on");
        const auto s = line.next();
        REQUIRE(s.has_value());
        CHECK(!s->on);
        CHECK((s->time_ns - before) / 1'000'000 >= limits.silence_ms - 1);
        // The holder says so after it has done so.
        while (h->beat())
            ::poll(nullptr, 0, 50);
        CHECK(!h->beat());
    }
    // Switched on again it is as before; where this thread stands still for so long it is silent once more.
    bool holds = false;
    for (int i = 0; i < 1000 && !holds; ++i)
        holds = h->set(true) && h->beat();
    CHECK(holds);
}

TEST_CASE("a line that cannot be switched is reported")
{
    fake_line line;
    line.break_it();
    const auto h = start(line);
    CHECK(!h->set(true));
    CHECK(h->set(false));
    CHECK(next_record(line) == "off");
}

TEST_CASE("a refused off is answered as such, and at its end the holder tries again by itself")
{
    fake_line line;
    line.refuse_off(4);
    auto h = start(line);
    CHECK(h->set(true));
    CHECK(next_record(line) == "on");
    CHECK(!h->set(false));
    CHECK(!h->set(false));
    const detail::owned_fd holder = open_pidfd(h->pid());
    h.reset();
    CHECK(next_record(line) == "off");
    CHECK(ends(holder));
}

TEST_CASE(
    "after an off that failed the holder takes the line for on, and tries again when the player is silent")
{
    fake_line line;
    line.refuse_off(1);
    amplifier::holder_limits limits = patient;
    limits.silence_ms = 100;
    const auto h = start(line, never, limits);
    CHECK(h->set(true));
    CHECK(next_record(line) == "on");
    CHECK_FALSE(h->set(false));
    CHECK(next_record(line) == "off"); // without a command
}

TEST_CASE("the holder keeps nothing of the player except the line")
{
    std::ofstream other("/dev/null");
    const int high = ::fcntl(STDIN_FILENO, F_DUPFD, 700);
    ::mlockall(MCL_CURRENT);
    fake_line line;
    const auto h = start(line);
    ::munlockall();
    ::close(high);

    const std::filesystem::path proc = "/proc/" + std::to_string(h->pid());
    std::size_t open = 0;
    for (const auto& entry : std::filesystem::directory_iterator(proc / "fd")) {
        CAPTURE(std::filesystem::read_symlink(entry.path()).string());
        ++open;
    }
    CHECK(open == 3); // the line, the socket, the pidfd
    CHECK(std::filesystem::read_symlink(proc / "cwd") == "/");
    CHECK(read_status(h->pid(), "Name") == "tactor-amp");
    CHECK(read_status(h->pid(), "VmLck") == "0 kB");
    CHECK(::getsid(h->pid()) == h->pid());
    CHECK(read_status(h->pid(), "PPid") != std::to_string(::getpid()));
}

TEST_CASE("two holders do not keep each other alive")
{
    fake_line first;
    fake_line second;
    auto a = start(first);
    auto b = start(second);
    CHECK(a->set(true));
    CHECK(b->set(true));
    CHECK(next_record(first) == "on");
    CHECK(next_record(second) == "on");
    a.reset();
    CHECK(next_record(first) == "off");
    CHECK(b->set(true));
    CHECK(next_record(second) == "on");
    b.reset();
    CHECK(next_record(second) == "off");
}

TEST_CASE("beat and set notice a killed holder, and the player switches off itself")
{
    for (const bool by_beat : {true, false}) {
        fake_line line;
        int rescues = 0;
        const auto h = start(line, [&] { return ++rescues > 0; });
        CHECK(h->set(true));
        const detail::owned_fd holder = open_pidfd(h->pid());
        ::kill(h->pid(), SIGKILL);
        CHECK(ends(holder));
        CHECK(!(by_beat ? h->beat() : h->set(true)));
        CHECK(rescues == 1);
        CHECK(h->set(false)); // it is off already
        CHECK(!h->set(true));
        CHECK(!h->beat());
        CHECK(rescues == 1);
    }
}

TEST_CASE("a failed rescue is tried again at the next off")
{
    fake_line line;
    int rescues = 0;
    const auto h = start(line, [&] { return ++rescues == 3; });
    const detail::owned_fd holder = open_pidfd(h->pid());
    ::kill(h->pid(), SIGKILL);
    CHECK(ends(holder));
    CHECK(!h->beat());
    CHECK(!h->set(false));
    CHECK(h->set(false));
    CHECK(rescues == 3);
}

TEST_CASE("a holder that hangs loses the line to the player")
{
    fake_line line;
    int rescues = 0;
    amplifier::holder_limits limits = patient;
    limits.answer_ms = 10'000;
    const auto h = start(
        line, [&] { return ++rescues > 0; }, limits);
    const detail::owned_fd holder = open_pidfd(h->pid());
    CHECK(h->set(true));
    ::kill(h->pid(), SIGSTOP);
    CHECK(h->set(false));
    CHECK(rescues == 1);
    CHECK(ends(holder));
}

TEST_CASE("a holder that does not answer beats is given up")
{
    fake_line line;
    int rescues = 0;
    amplifier::holder_limits limits = patient;
    limits.unanswered = amplifier::holder_limits{}.unanswered;
    const auto h = start(
        line, [&] { return ++rescues > 0; }, limits);
    ::kill(h->pid(), SIGSTOP);
    int beats = 0;
    while (h->beat())
        REQUIRE(++beats <= 10);
    CHECK(beats == 10);
    CHECK(rescues == 1);
}

TEST_CASE("a player with busy threads can start one")
{
    std::atomic<bool> stop = false;
    std::vector<std::thread> busy;
    for (int i = 0; i < 3; ++i)
        busy.emplace_back([&] {
            while (!stop)
                std::vector<char>(1000, 'x').shrink_to_fit();
        });
    for (int i = 0; i < 30; ++i) {
        fake_line line;
        auto h = start(line);
        CHECK(h->set(true));
        h.reset();
        CHECK(next_record(line) == "on");
        CHECK(next_record(line) == "off");
    }
    stop = true;
    for (std::thread& t : busy)
        t.join();
}

TEST_CASE("without descriptors there is an error instead of a holder")
{
    fake_line line;
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit none{0, 0};
        ::setrlimit(RLIMIT_NOFILE, &none);
        try {
            start(line);
        } catch (const error& e) {
            ::_exit(e.kind() == error_kind::not_available && e.os_code() == EMFILE ? 7 : 1);
        }
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(WEXITSTATUS(status) == 7);
}

TEST_CASE("a player killed in any way leaves the line off")
{
    for (const int number : {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGABRT, SIGSEGV}) {
        CAPTURE(number);
        fake_line line;
        const player p(line, patient, keep_beating);
        const detail::owned_fd holder = open_pidfd(p.holder());
        p.signal(number);
        CHECK(next_record(line) == "off");
        CHECK(ends(holder));
        CHECK(!line.next(0).has_value());
    }
}

TEST_CASE("a player that exits without a word leaves the line off")
{
    fake_line line;
    const player p(line, patient, [](amplifier::holder_link&, const auto&) { ::_exit(3); });
    CHECK(next_record(line) == "off");
}

TEST_CASE("signals to the player's group and to the holder do not touch the holder")
{
    constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGQUIT, SIGUSR1, SIGALRM, SIGPIPE, SIGTTOU};
    fake_line line;
    const player p(line, patient, keep_beating, [&] {
        ::setpgid(0, 0);
        for (const int s : signals)
            ::signal(s, SIG_IGN);
    });
    CHECK(::getsid(p.holder()) != ::getsid(p.pid()));
    for (const int s : signals) {
        CHECK(::kill(-p.pid(), s) == 0);
        CHECK(::kill(p.holder(), s) == 0);
    }
    CHECK(!line.next(400).has_value()); // neither switched nor lapsed
    ::kill(-p.pid(), SIGKILL);
    CHECK(next_record(line) == "off");
}

TEST_CASE("a closed terminal leaves the line off" * doctest::skip(no_terminals()))
{
    const int terminal = new_terminal();
    REQUIRE(terminal >= 0);
    const std::string name = ::ptsname(terminal);
    fake_line line;
    const player p(line, patient, keep_beating, [&] {
        ::close(terminal);
        ::setsid();
        ::ioctl(::open(name.c_str(), O_RDWR), TIOCSCTTY, 0);
    });
    ::close(terminal);
    CHECK(next_record(line) == "off");
}

TEST_CASE("another process that keeps the player's descriptors open does not keep the line on")
{
    fake_line line;
    const player p(line, patient, [](amplifier::holder_link& h, const std::function<void(int)>& tell) {
        const pid_t child = ::fork();
        if (child == 0)
            for (;;)
                ::pause();
        tell(child);
        keep_beating(h, tell);
    });
    const pid_t other = p.told();
    REQUIRE(other > 0);
    p.signal(SIGKILL);
    CHECK(next_record(line) == "off"); // long before silence would
    ::kill(other, SIGKILL);
}

} // namespace holder_test
