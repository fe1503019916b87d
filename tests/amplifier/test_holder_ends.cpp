// SPDX-License-Identifier: MIT
// Ends of the player, after each of which the line goes off. Real processes; timed/ has the latency.
#include <csignal>
#include <cstdio>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include "fake_line.hpp"

namespace holder_ends_test {

using namespace tactor;
using namespace tactor::test;

namespace {

void check_off(const fake_line& line)
{
    const auto s = line.next();
    REQUIRE(s.has_value());
    CHECK(!s->on);
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

TEST_CASE("a player killed in any way leaves the line off")
{
    for (const int number : {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGABRT, SIGSEGV}) {
        CAPTURE(number);
        fake_line line;
        const player p(line, patient, keep_beating);
        const int holder = open_pidfd(p.holder());
        p.signal(number);
        check_off(line);
        CHECK(ends(holder));
        ::close(holder);
        CHECK(!line.next(0).has_value());
    }
}

TEST_CASE("a player that exits without a word leaves the line off")
{
    fake_line line;
    const player p(line, patient, [](amplifier::holder_link&, const auto&) { ::_exit(3); });
    check_off(line);
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
    check_off(line);
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
    check_off(line);
}

TEST_CASE("another process that keeps the player's descriptors open does not keep the line on")
{
    fake_line line;
    const player p(line, patient, keep_beating_with_a_child);
    const pid_t other = p.told();
    REQUIRE(other > 0);
    p.signal(SIGKILL);
    const auto s = line.next(); // long before silence would
    ::kill(other, SIGKILL);
    REQUIRE(s.has_value());
    CHECK(!s->on);
}

} // namespace holder_ends_test
