// SPDX-License-Identifier: MIT
// Web pages and peers that may ask, the order of a page's messages, listening sockets, and Base64.
#include <cerrno>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "net/access.hpp"
#include "net/listen.hpp"
#include "net/rpc.hpp"
#include "net/web.hpp"

namespace web_access_test {

using namespace tactor::net;
using namespace tactor;

TEST_CASE("a browser may call this server by its names")
{
    const std::string local = "127.0.0.1:4003";
    for (const char* ours : {"127.0.0.1:4003", "localhost:4003", "LocalHost:4003"})
        CHECK_MESSAGE(is_server_host(ours, local, {}), ours);
    // A foreign name for this address, another address, another port, no port, and rubbish.
    for (const char* not_ours :
         {"evil.example:4003", "127.0.0.2:4003", "127.1:4003", "0x7f000001:4003", "localhost:4004",
          "localhost", "127.0.0.1", "localhost.:4003", "localhost:4003:4003", "[::1]:4003", "", ":", ":4003",
          "[", "[]", "[127.0.0.1]:4003", "[127.0.0.1]:4003x", "localhost:04003", "localhost: 4003"})
        CHECK_FALSE_MESSAGE(is_server_host(not_ours, local, {}), not_ours);
    CHECK_FALSE(is_server_host(std::string_view("127.0.0.1\0.evil:4003", 20), local, {}));
    CHECK(is_server_host("[::1]:4003", "[::1]:4003", {}));
    CHECK(is_server_host("[0:0::1]:4003", "[::1]:4003", {}));
    CHECK_FALSE(is_server_host("[::1]", "[::1]:4003", {}));
    // A server on [::] hears IPv4, too.
    CHECK(is_server_host("192.168.1.7:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK(is_server_host("[::ffff:192.168.1.7]:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK_FALSE(is_server_host("192.168.1.8:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK(is_server_host("localhost", "127.0.0.1:80", {}));
    CHECK(is_server_host("192.168.1.7:4003", "192.168.1.7:4003", {}));
}

TEST_CASE("the owner can allow names")
{
    const std::vector<std::string> allowed{"pi.lan", "desk.lan:8080"};
    CHECK(is_server_host("pi.lan", "10.0.0.2:4003", allowed));
    CHECK(is_server_host("PI.lan:4003", "10.0.0.2:4003", allowed));
    CHECK(is_server_host("desk.lan:8080", "10.0.0.2:4003", allowed));
    CHECK_FALSE(is_server_host("desk.lan:4003", "10.0.0.2:4003", allowed));
    CHECK_FALSE(is_server_host("pi.lan.evil.example", "10.0.0.2:4003", allowed));
    CHECK_FALSE(is_server_host("xpi.lan", "10.0.0.2:4003", allowed));
    // The page's policy gets a name and a port, and nothing else.
    for (const char* nonsense : {"pi.lan:evil", "pi.lan:80;x", "pi.lan:", "pi.lan:4003 x", "pi.lan:123456",
                                 "[pi.lan]:4003", "[pi.lan"})
        CHECK_FALSE_MESSAGE(is_server_host(nonsense, "10.0.0.2:4003", allowed), nonsense);
    CHECK_FALSE(is_server_host("", "10.0.0.2:4003", {""}));
}

TEST_CASE("only pages of this server and allowed ones may connect")
{
    const std::string host = "127.0.0.1:4003";
    const std::vector<std::string> allowed{"pi.lan", "desk.lan:8443"};
    CHECK(is_server_origin("http://127.0.0.1:4003", host, allowed));
    CHECK(is_server_origin("http://pi.lan", host, allowed));
    CHECK(is_server_origin("https://pi.lan", host, allowed));
    CHECK(is_server_origin("https://desk.lan:8443", host, allowed));
    for (const char* not_ours :
         {"null", "", "http://", "https://127.0.0.1:4003", "http://localhost:4003", "http://127.0.0.1",
          "http://evil.example", "ftp://pi.lan", "pi.lan", "https://desk.lan",
          "http://127.0.0.1:4003.evil.example", "http://pi.lan@evil.example"})
        CHECK_FALSE_MESSAGE(is_server_origin(not_ours, host, allowed), not_ours);
}

TEST_CASE("the target of a request is a path or a whole address")
{
    const auto is = [](std::string_view target, std::string_view host, std::string_view path) {
        const web_target t = parse_target(target, "said:4003");
        return t.host == host && t.path == path;
    };
    CHECK(is("/rpc", "said:4003", "/rpc"));
    CHECK(is("/", "said:4003", "/"));
    CHECK(is("http://pi.lan:4003/rpc", "pi.lan:4003", "/rpc"));
    CHECK(is("HTTP://[::1]:4003/a/b?c", "[::1]:4003", "/a/b"));
    CHECK(is("/?x", "said:4003", "/"));
    CHECK(is("/rpc?a/b?c", "said:4003", "/rpc"));
    CHECK(is("http://pi.lan?x/y", "pi.lan", "/"));
    CHECK(is("http://pi.lan", "pi.lan", "/"));
    CHECK(is("http:///rpc", "", "/rpc"));
    for (const char* path : {"https://pi.lan/rpc", "http:/rpc", "*", "", "http"})
        CHECK_MESSAGE(is(path, "said:4003", path), path);
}

TEST_CASE("tokens are read from the header")
{
    CHECK(bearer_token("Bearer secret") == "secret");
    CHECK(bearer_token("bearer secret") == "secret");
    CHECK(bearer_token("Basic secret").empty());
    CHECK(bearer_token("Bearer ").empty());
    CHECK(bearer_token("").empty());
}

namespace {

bool heard(const char* from, const std::vector<std::string>& prefixes)
{
    std::vector<address_prefix> peers;
    for (const std::string& p : prefixes)
        peers.push_back(parse_prefix(p));
    return is_accepted(boost::asio::ip::make_address(from), peers);
}

} // namespace

TEST_CASE("without a list only this machine is heard")
{
    for (const char* own : {"127.0.0.1", "127.9.8.7", "::1", "::ffff:127.0.0.1"})
        CHECK_MESSAGE(heard(own, {}), own);
    for (const char* other :
         {"10.0.0.1", "128.0.0.1", "126.255.255.255", "::2", "::ffff:10.0.0.1", "fe80::1"})
        CHECK_FALSE_MESSAGE(heard(other, {}), other);
}

TEST_CASE("a prefix is compared to its last bit")
{
    CHECK(heard("192.168.1.255", {"192.168.1.0/24"}));
    CHECK_FALSE(heard("192.168.2.0", {"192.168.1.0/24"}));
    CHECK(heard("10.15.0.1", {"10.8.0.0/13"}));
    CHECK_FALSE(heard("10.16.0.1", {"10.8.0.0/13"}));
    CHECK(heard("10.0.0.5", {"10.0.0.5"}));
    CHECK_FALSE(heard("10.0.0.4", {"10.0.0.5"}));
    CHECK(heard("1.2.3.4", {"0.0.0.0/0"}));
    CHECK_FALSE(heard("fd00::1", {"0.0.0.0/0"}));
    CHECK(heard("fdff::1", {"10.0.0.1", "fd00::/8"}));
    CHECK_FALSE(heard("fc00::1", {"fd00::/8"}));
    CHECK(heard("::ffff:192.168.1.9", {"192.168.1.0/24"}));
    CHECK(heard("192.168.1.9", {"192.168.1.77/24"}));
}

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

TEST_CASE("a page gets the messages of all threads in the order in which they were sent")
{
    owned_fd listening = listen_tcp({}, "tcp");
    const std::string address = local_address(listening.get());
    const host_and_port at = parse_host(address, "tcp");
    page_server page(std::move(listening), {},
                     {[&page](page_server::visitor v, std::string_view) {
                          page.send(v, "first");
                          std::thread([&page, v] { page.send(v, "second"); }).join();
                          return true;
                      },
                      [](page_server::visitor) {}});
    boost::asio::io_context io;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> browser(io);
    browser.next_layer().connect({boost::asio::ip::make_address(at.host), at.port});
    browser.handshake(address, "/rpc");
    browser.write(boost::asio::buffer(std::string("{}")));
    std::vector<std::string> heard;
    for (int i = 0; i < 2; ++i) {
        boost::beast::flat_buffer message;
        browser.read(message);
        heard.push_back(boost::beast::buffers_to_string(message.data()));
    }
    CHECK(heard == std::vector<std::string>{"first", "second"});
}

TEST_CASE("bytes become base64 and come back, as RFC 4648 says")
{
    for (const auto& [bytes, text] : {std::pair<std::string_view, std::string_view>{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {"foob", "Zm9vYg=="},
                                      {"fooba", "Zm9vYmE="},
                                      {"foobar", "Zm9vYmFy"}}) {
        std::string made = "x";
        append_base64(made, bytes);
        CHECK(made == "x" + std::string(text));
        CHECK(decode_base64(text) == bytes);
    }
    std::string all;
    for (int i = 0; i < 256; ++i)
        all += static_cast<char>(i);
    std::string made;
    append_base64(made, all);
    CHECK(decode_base64(made) == all);
}

TEST_CASE("other texts are no base64")
{
    for (const char* text :
         {"Z", "Zg", "Zg=", "Zg==\n", "Z===", "====", "Zm9v!A==", "Zm-v", "Zh==", "Zm9=", "Zg==Zg=="})
        CHECK_FALSE(decode_base64(text));
}

} // namespace web_access_test
