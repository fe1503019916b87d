// SPDX-License-Identifier: MIT
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/setup.hpp>

#include "caught.hpp"
#include "options/serve.hpp"

namespace serve_test {

using namespace tactor;

TEST_CASE("[serve]: all keys, and none")
{
    const setup all = parse_setup(R"([serve]
socket = "/run/x.sock"
tcp = 4001
osc = "0.0.0.0:4002"
http = "[::1]:4003"
token_file = "/etc/t"
allow_hosts = ["pi.local:4003"]
osc_peers = ["10.0.0.0/8", "::1"]
max_level_dbfs = -20
idle_stop_s = 60
max_clients = 10
kept_clients = 2
max_strokes = 3
max_live_strokes = 0
max_points_per_s = 100
max_stroke_s = 5
max_message_bytes = 2000
max_nesting = 10
max_message_s = 1
max_unread_bytes = 3000
)",
                                  "t");
    const options::serve_settings s = options::read_serve(all.serve);
    CHECK(s.socket == "/run/x.sock");
    CHECK(s.tcp == "4001");
    CHECK(s.osc == "0.0.0.0:4002");
    CHECK(s.http == "[::1]:4003");
    CHECK(s.token_file == "/etc/t");
    CHECK(s.allow_hosts.size() == 1);
    CHECK(s.osc_peers.size() == 2);
    CHECK(s.max_level_dbfs == -20.0);
    CHECK(s.idle_stop_s == 60.0);
    CHECK(s.limits.max_clients == 10U);
    CHECK(s.limits.kept_clients == 2U);
    CHECK(s.limits.max_strokes == 3U);
    CHECK(s.limits.max_live_strokes == 0U);
    CHECK(s.limits.max_points_per_s == 100U);
    CHECK(s.limits.max_stroke_s == 5.0);
    CHECK(s.limits.max_message_bytes == 2000U);
    CHECK(s.limits.max_nesting == 10U);
    CHECK(s.limits.max_message_s == 1.0);
    CHECK(s.limits.max_unread_bytes == 3000U);
    CHECK(parse_setup("", "t").serve.empty());
    CHECK_FALSE(options::read_serve(parse_setup("[serve]\n", "t").serve).tcp);
}

TEST_CASE("[serve]: impossible values are refused with their place")
{
    const auto says = [](const std::string& line) {
        return caught_message([&] {
            static_cast<void>(options::read_serve(parse_setup("[serve]\n" + line + "\n", "t").serve));
        });
    };
    CHECK(says("tpc = 1").find("t:2:") == 0);
    CHECK(says("tpc = 1").find("tcp") != std::string::npos);
    for (const char* line : {"tcp = 70000", "tcp = 1.5", "tcp = 'x'", "http = '::1'", "http = 'a:'",
                             "osc = ':1'", "osc = '[::1]:65536'", "socket = ''", "allow_hosts = 'x'",
                             "osc_peers = [1]", "max_level_dbfs = 1", "idle_stop_s = 0", "max_clients = 0",
                             "max_strokes = -1", "max_message_bytes = 1.5", "kept_clients = 64"})
        CHECK_MESSAGE(says(line).find("t:2:") == 0, line);
    for (const char* bad : {"/", "10.0.0.0/33", "::/129", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x", "10.0.0",
                            "example.org", "10.0.0.0/8/8", "10.0.0.0/ 8", "[::1]"})
        CHECK(says(fmt::format("osc_peers = ['::1', '{}']", bad)) ==
              fmt::format("t:2:21: \"{}\" is neither an address nor a prefix (such as 192.168.1.7, "
                          "192.168.1.0/24 or fd00::/8)",
                          bad));
    for (const char* bad : {"https://draw.example", "draw.example/", "draw.example/page", "*.example", "a b",
                            "pi.lan:", "pi.lan:0", "pi.lan:080", "pi.lan:65536", "pi.lan:http", ":80", "::1",
                            "user@pi.lan", "[]", "[pi.lan]", "pi.lan?x"})
        CHECK(says(fmt::format("allow_hosts = ['pi.lan', '{}']", bad))
                  .find(fmt::format("t:2:26: \"{}\" is no host (HOST[:PORT] without a scheme", bad)) == 0);
    CHECK(says("http = 'http://pi.lan:80'").find("t:2:8: \"http://pi.lan:80\" is no address") == 0);
    CHECK(says("tcp = 'pi.lan/x:80'").find("t:2:7: \"pi.lan/x:80\" is no address") == 0);
    const auto hosts = parse_setup(
        "[serve]\nallow_hosts = ['pi.lan', 'pi.lan:8080', '10.0.0.7:80', '[fd00::7]', '[::1]:80']\n", "t");
    CHECK(options::read_serve(hosts.serve).allow_hosts.size() == 5);
    const auto s =
        parse_setup("[serve]\nosc_peers = ['1.2.3.4', '::/0', '0.0.0.0/0', 'fe80::1%eth0']\n", "t");
    CHECK(options::read_serve(s.serve).osc_peers.size() == 4);
}

} // namespace serve_test
