// SPDX-License-Identifier: MIT
// Listening that fails, with reasons.
#include "net/listen.hpp"

#include <cerrno>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"

namespace listen_test {

using namespace tactor;
using namespace tactor::net;

TEST_CASE("a locked folder is not awaited without end")
{
    const folder here;
    const owned_fd other(::open((here / ".").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    REQUIRE(::flock(other.get(), LOCK_EX) == 0);
    CHECK(listen_unix((here / "s").string(), 0600, {}));
}

TEST_CASE("a refused listener has its errno")
{
    const folder here;
    CHECK(os_code([&] { listen_unix((here / "none/s").string(), 0600, {}); }) == ENOENT);
    CHECK(os_code([&] { listen_unix((here.write("file") / "s").string(), 0600, {}); }) == ENOTDIR);
    const owned_fd first = listen_tcp({}, "port");
    CHECK(os_code([&] { listen_tcp(parse_host(local_address(first.get()), "port"), "port"); }) == EADDRINUSE);
}

TEST_CASE("a port in use is reported with its process")
{
    const auto says = [](const std::function<void()>& call) {
        try {
            call();
        } catch (const error& e) {
            CHECK(e.kind() == error_kind::not_available);
            return std::string(e.why());
        }
        return std::string();
    };
    const std::string me = "process " + std::to_string(::getpid());
    const owned_fd stream = listen_tcp({}, "tcp");
    const host_and_port tcp = parse_host(local_address(stream.get()), "tcp");
    CHECK(has(says([&] { listen_tcp(tcp, "tcp"); }), me));
    const owned_fd packets = bind_udp({}, "osc");
    const host_and_port udp = parse_host(local_address(packets.get()), "osc");
    CHECK(has(says([&] { bind_udp(udp, "osc"); }), me));
    CHECK(find_port_holder(tcp.port, true).ends_with(me));
    CHECK(find_port_holder(0, true).empty());
}

TEST_CASE("a peer's address is told without its port")
{
    const owned_fd listener = listen_tcp({}, "tcp");
    const host_and_port at = parse_host(local_address(listener.get()), "tcp");
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket s(io);
    s.open(boost::asio::ip::tcp::v4());
    CHECK(peer_address(s.native_handle()).empty()); // not connected
    s.connect({boost::asio::ip::make_address(at.host), at.port});
    CHECK(peer_address(s.native_handle()) == "127.0.0.1");
}

} // namespace listen_test
