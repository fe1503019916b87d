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
    using settings = options::serve_settings;
    struct key {
        const char* line;
        bool (*kept)(const settings&);
    };
    const key all[] = {
        {"socket = '/run/x.sock'", [](const settings& s) { return s.socket == "/run/x.sock"; }},
        {"tcp = 4001", [](const settings& s) { return s.tcp == "4001"; }},
        {"bhaptics = 15881", [](const settings& s) { return s.bhaptics == "15881"; }},
        {"osc = '0.0.0.0:4002'", [](const settings& s) { return s.osc == "0.0.0.0:4002"; }},
        {"http = '[::1]:4003'", [](const settings& s) { return s.http == "[::1]:4003"; }},
        {"token_file = '/etc/t'", [](const settings& s) { return s.token_file == "/etc/t"; }},
        {"allow_hosts = ['pi.local:4003']", [](const settings& s) { return s.allow_hosts.size() == 1; }},
        {"osc_peers = ['10.0.0.0/8', '::1']", [](const settings& s) { return s.osc_peers.size() == 2; }},
        {"max_level_dbfs = -20", [](const settings& s) { return s.max_level_dbfs == -20.0; }},
        {"idle_stop_s = 60", [](const settings& s) { return s.idle_stop_s == 60.0; }},
        {"max_clients = 10", [](const settings& s) { return s.limits.max_clients == 10; }},
        {"kept_clients = 2", [](const settings& s) { return s.limits.kept_clients == 2; }},
        {"max_strokes = 3", [](const settings& s) { return s.limits.max_strokes == 3; }},
        {"max_live_strokes = 0", [](const settings& s) { return s.limits.max_live_strokes == 0; }},
        {"max_points_per_s = 100", [](const settings& s) { return s.limits.max_points_per_s == 100.0; }},
        {"max_stroke_s = 5", [](const settings& s) { return s.limits.max_stroke_s == 5.0; }},
        {"max_message_bytes = 2000", [](const settings& s) { return s.limits.max_message_bytes == 2000; }},
        {"max_nesting = 10", [](const settings& s) { return s.limits.max_nesting == 10; }},
        {"max_message_s = 1", [](const settings& s) { return s.limits.max_message_s == 1.0; }},
        {"max_unread_bytes = 3000", [](const settings& s) { return s.limits.max_unread_bytes == 3000; }},
    };
    std::string text = "[serve]\n";
    for (const key& k : all)
        text += std::string(k.line) + "\n";
    const settings read = options::read_serve(parse_setup(text, "t").serve);
    for (const key& k : all)
        CHECK_MESSAGE(k.kept(read), k.line);
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
              fmt::format("t:2:21: \"{}\" is neither an address nor a prefix (use an address or a prefix, "
                          "such as 192.168.1.7, "
                          "192.168.1.0/24 or fd00::/8)",
                          bad));
    for (const char* bad : {"https://draw.example", "draw.example/", "draw.example/page", "*.example", "a b",
                            "pi.lan:", "pi.lan:0", "pi.lan:080", "pi.lan:65536", "pi.lan:http", ":80", "::1",
                            "user@pi.lan", "[]", "[pi.lan]", "pi.lan?x"})
        CHECK(says(fmt::format("allow_hosts = ['pi.lan', '{}']", bad))
                  .find(fmt::format("t:2:26: \"{}\" is not a host (", bad)) == 0);
    CHECK(says("http = 'http://pi.lan:80'").find("t:2:8: \"http://pi.lan:80\" is not an address") == 0);
    CHECK(says("tcp = 'pi.lan/x:80'").find("t:2:7: \"pi.lan/x:80\" is not an address") == 0);
    const auto hosts = parse_setup(
        "[serve]\nallow_hosts = ['pi.lan', 'pi.lan:8080', '10.0.0.7:80', '[fd00::7]', '[::1]:80']\n", "t");
    CHECK(options::read_serve(hosts.serve).allow_hosts.size() == 5);
    const auto s =
        parse_setup("[serve]\nosc_peers = ['1.2.3.4', '::/0', '0.0.0.0/0', 'fe80::1%eth0']\n", "t");
    CHECK(options::read_serve(s.serve).osc_peers.size() == 4);
}

} // namespace serve_test
