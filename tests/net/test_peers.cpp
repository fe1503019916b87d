// SPDX-License-Identifier: MIT
// Peers whose datagrams are heard.
#include "net/access.hpp"

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "has.hpp"

namespace peers_test {

using namespace tactor;
using namespace tactor::net;

namespace {

bool heard(const char* from, const std::vector<std::string>& prefixes)
{
    std::vector<address_prefix> peers;
    for (const std::string& p : prefixes)
        peers.push_back(parse_prefix(p, "osc_peers"));
    return is_accepted(boost::asio::ip::make_address(from), peers);
}

} // namespace

TEST_CASE("without a list only this machine is heard")
{
    for (const char* own : {"127.0.0.1", "127.9.8.7", "::1", "::ffff:127.0.0.1"}) {
        CAPTURE(own);
        CHECK(heard(own, {}));
    }
    for (const char* other :
         {"10.0.0.1", "128.0.0.1", "126.255.255.255", "::2", "::ffff:10.0.0.1", "fe80::1"}) {
        CAPTURE(other);
        CHECK_FALSE(heard(other, {}));
    }
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

TEST_CASE("a bad prefix is refused by its name")
{
    for (const char* bad : {"", "/", "10.0.0.0/33", "::/129", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x",
                            "10.0.0", "example.org", "10.0.0.0/8/8", "10.0.0.0/ 8", "[::1]"}) {
        CAPTURE(bad);
        const std::string said = caught_message([&] { static_cast<void>(parse_prefix(bad, "osc_peers")); });
        CHECK(has(said, "osc_peers"));
        CHECK(has(said, bad));
    }
}

} // namespace peers_test
