// SPDX-License-Identifier: MIT
#include "session/process.hpp"

#include <csignal>
#include <string>

#include <doctest/doctest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace interrupt_test {

using tactor::session::interrupt;

namespace {

// Runs `act` in a child. Returns its wait status, and its standard error.
template <class Act>
std::pair<int, std::string> in_child(const Act& act)
{
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(ends[1], STDERR_FILENO);
        act();
        ::_exit(0);
    }
    ::close(ends[1]);
    std::string printed;
    char bytes[256];
    for (ssize_t n = 0; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;)
        printed.append(bytes, static_cast<std::size_t>(n));
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    return {status, printed};
}

} // namespace

TEST_CASE("a program held up by a device is ended after its time, with the status of the signal")
{
    const auto [status, printed] = in_child([] {
        interrupt stop(1);
        ::raise(SIGTERM);
        while (stop.poll() == 0)
            ;
        for (;;) // like a library that hangs
            ::poll(nullptr, 0, -1);
    });
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + SIGTERM);
    CHECK(printed == "tactor: the device does not answer: ended anyway\n");
}

TEST_CASE("a program that ends by itself has no time limit any more")
{
    const auto [status, printed] = in_child([] {
        {
            interrupt stop(1);
            ::raise(SIGINT);
            while (stop.poll() == 0)
                ;
        }
        ::_exit(::alarm(0) == 0 ? 7 : 8);
    });
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 7);
    CHECK(printed.empty());
}

} // namespace interrupt_test
