// SPDX-License-Identifier: MIT
#include "net/listen.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <tactor/error.hpp>

#include "folder.hpp"

namespace listen_test {

using namespace tactor;

namespace {

/// A Unix socket and its address.
struct end_point {
    detail::owned_fd fd{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
    sockaddr_un at{};

    explicit end_point(const std::string& path)
    {
        at.sun_family = AF_UNIX;
        REQUIRE(path.size() < sizeof at.sun_path);
        std::memcpy(&at.sun_path[0], path.c_str(), path.size() + 1);
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket API requires it
    const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&at); }
    bool connects() const { return ::connect(fd.get(), address(), sizeof at) == 0; }
};

} // namespace

TEST_CASE("a socket at which a process listens is in use, also while its queue is full")
{
    const folder here;
    const std::string path = (here / "s.sock").string();
    const end_point other(path);
    REQUIRE(::bind(other.fd.get(), other.address(), sizeof other.at) == 0);
    REQUIRE(::listen(other.fd.get(), 0) == 0);
    std::vector<end_point> waiting;
    for (const bool is_full : {false, true}) {
        error_kind kind = error_kind::runtime;
        std::string why;
        try {
            net::listen_unix(path, S_IRUSR | S_IWUSR, {});
        } catch (const error& e) {
            kind = e.kind();
            why = e.why();
        }
        CAPTURE(is_full);
        CHECK(kind == error_kind::not_available);
        CHECK(why.ends_with("listens there already"));
        struct stat there {};
        CHECK(::lstat(path.c_str(), &there) == 0);
        do
            waiting.emplace_back(path);
        while (waiting.back().connects());
        REQUIRE(errno == EAGAIN);
    }
}

TEST_CASE("a socket that a dead process has left is free")
{
    const folder here;
    const std::string path = (here / "s.sock").string();
    {
        const end_point dead(path);
        REQUIRE(::bind(dead.fd.get(), dead.address(), sizeof dead.at) == 0);
        REQUIRE(::listen(dead.fd.get(), 0) == 0);
    }
    const net::owned_fd mine = net::listen_unix(path, S_IRUSR | S_IWUSR, {});
    CHECK(end_point(path).connects());
}

} // namespace listen_test
