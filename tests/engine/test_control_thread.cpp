// SPDX-License-Identifier: MIT
// The control thread where the system gives no thread.
#include <system_error>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/control/control_thread.hpp"
#include "rt/event_fd.hpp"

namespace control_thread_test {

using namespace tactor;

TEST_CASE("a control thread that cannot be made leaves the descriptor of its event open")
{
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        constexpr uid_t nobody = 65534; // root may have any number of threads
        const rlimit none{0, 0};
        if ((::geteuid() == 0 && ::setuid(nobody) != 0) || ::setrlimit(RLIMIT_NPROC, &none) != 0)
            ::_exit(2);
        rt::event_fd event;
        try {
            const engine::control_thread t(event, [] {});
            ::_exit(3);
        } catch (const std::system_error&) {
            ::_exit(::fcntl(event.fd(), F_GETFD) < 0 ? 1 : 0);
        }
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
}

} // namespace control_thread_test
