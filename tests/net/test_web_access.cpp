// SPDX-License-Identifier: MIT
// Browsers' requests that are meant for this server.
#include "net/access.hpp"

#include <doctest/doctest.h>

namespace web_access_test {

using namespace tactor::net;

TEST_CASE("a browser may call this server by its names")
{
    const std::string local = "127.0.0.1:4003";
    for (const char* ours : {"127.0.0.1:4003", "localhost:4003", "LocalHost:4003"}) {
        CAPTURE(ours);
        CHECK(host_is_ours(ours, local, {}));
    }
    // A foreign name for this address, another address, another port, no port, and rubbish.
    for (const char* not_ours :
         {"evil.example:4003", "127.0.0.2:4003", "127.1:4003", "0x7f000001:4003", "localhost:4004",
          "localhost", "127.0.0.1", "localhost.:4003", "localhost:4003:4003", "[::1]:4003", "", ":", ":4003",
          "[", "[]", "[127.0.0.1]:4003", "[127.0.0.1]:4003x", "localhost:04003", "localhost: 4003"}) {
        CAPTURE(not_ours);
        CHECK_FALSE(host_is_ours(not_ours, local, {}));
    }
    CHECK_FALSE(host_is_ours(std::string_view("127.0.0.1\0.evil:4003", 20), local, {}));
    CHECK(host_is_ours("[::1]:4003", "[::1]:4003", {}));
    CHECK(host_is_ours("[0:0::1]:4003", "[::1]:4003", {}));
    CHECK_FALSE(host_is_ours("[::1]", "[::1]:4003", {}));
    // A server on [::] hears IPv4, too.
    CHECK(host_is_ours("192.168.1.7:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK(host_is_ours("[::ffff:192.168.1.7]:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK_FALSE(host_is_ours("192.168.1.8:4003", "[::ffff:192.168.1.7]:4003", {}));
    CHECK(host_is_ours("localhost", "127.0.0.1:80", {}));
    CHECK(host_is_ours("192.168.1.7:4003", "192.168.1.7:4003", {}));
}

TEST_CASE("the owner can allow names")
{
    const std::vector<std::string> allowed{"pi.lan", "desk.lan:8080"};
    CHECK(host_is_ours("pi.lan", "10.0.0.2:4003", allowed));
    CHECK(host_is_ours("PI.lan:4003", "10.0.0.2:4003", allowed));
    CHECK(host_is_ours("desk.lan:8080", "10.0.0.2:4003", allowed));
    CHECK_FALSE(host_is_ours("desk.lan:4003", "10.0.0.2:4003", allowed));
    CHECK_FALSE(host_is_ours("pi.lan.evil.example", "10.0.0.2:4003", allowed));
    CHECK_FALSE(host_is_ours("xpi.lan", "10.0.0.2:4003", allowed));
    // The page's policy gets a name and a port, and nothing else.
    for (const char* nonsense : {"pi.lan:evil", "pi.lan:80;x", "pi.lan:", "pi.lan:4003 x", "pi.lan:123456",
                                 "[pi.lan]:4003", "[pi.lan"}) {
        CAPTURE(nonsense);
        CHECK_FALSE(host_is_ours(nonsense, "10.0.0.2:4003", allowed));
    }
    CHECK_FALSE(host_is_ours("", "10.0.0.2:4003", {""}));
}

TEST_CASE("only pages of this server and allowed ones may connect")
{
    const std::string host = "127.0.0.1:4003";
    const std::vector<std::string> allowed{"pi.lan", "desk.lan:8443"};
    CHECK(origin_is_ours("http://127.0.0.1:4003", host, allowed));
    CHECK(origin_is_ours("http://pi.lan", host, allowed));
    CHECK(origin_is_ours("https://pi.lan", host, allowed));
    CHECK(origin_is_ours("https://desk.lan:8443", host, allowed));
    for (const char* not_ours :
         {"null", "", "http://", "https://127.0.0.1:4003", "http://localhost:4003", "http://127.0.0.1",
          "http://evil.example", "ftp://pi.lan", "pi.lan", "https://desk.lan",
          "http://127.0.0.1:4003.evil.example", "http://pi.lan@evil.example"}) {
        CAPTURE(not_ours);
        CHECK_FALSE(origin_is_ours(not_ours, host, allowed));
    }
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
    for (const char* path : {"https://pi.lan/rpc", "http:/rpc", "*", "", "http"}) {
        CAPTURE(path);
        CHECK(is(path, "said:4003", path));
    }
}

TEST_CASE("tokens are read from the header")
{
    CHECK(bearer_token("Bearer secret") == "secret");
    CHECK(bearer_token("bearer secret") == "secret");
    CHECK(bearer_token("Basic secret").empty());
    CHECK(bearer_token("Bearer ").empty());
    CHECK(bearer_token("").empty());
}

} // namespace web_access_test
