// SPDX-License-Identifier: MIT
#include "rt/event_fd.hpp"

#include <thread>

#include <fcntl.h>
#include <poll.h>

#include <doctest/doctest.h>

namespace event_fd_test {

TEST_CASE("an eventfd is readable after a signal and not after it was consumed")
{
    tactor::rt::event_fd e;
    pollfd p{.fd = e.fd(), .events = POLLIN, .revents = 0};
    CHECK(::poll(&p, 1, 0) == 0);
    CHECK(e.consume() == 0);
    e.signal();
    e.signal();
    CHECK(::poll(&p, 1, 0) == 1);
    CHECK(e.consume() == 2);
    CHECK(::poll(&p, 1, 0) == 0);
}

TEST_CASE("an eventfd does not block and is not inherited by programs")
{
    tactor::rt::event_fd e;
    CHECK((::fcntl(e.fd(), F_GETFL) & O_NONBLOCK) != 0);
    CHECK((::fcntl(e.fd(), F_GETFD) & FD_CLOEXEC) != 0);
}

} // namespace event_fd_test
