// SPDX-License-Identifier: MIT
// Senders of OSC: their numbers, their times, their messages, and their end.
#include "server/osc.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "has.hpp"
#include "rt/clock.hpp"
#include "service_rig.hpp"

namespace osc_clients_test {

using namespace tactor;
using namespace tactor::test;
using namespace std::string_literals;

namespace {

/// The service with senders of OSC, whose clock the test turns. Without a socket: what is sent waits in
/// `sent`.
class osc_rig : public running_rig {
public:
    using endpoint = server::osc_clients::endpoint;
    using values = std::vector<net::osc_value>;

    using running_rig::running_rig;

    static endpoint at(std::uint16_t port, const char* address = "127.0.0.1")
    {
        return {boost::asio::ip::make_address(address), port};
    }
    static std::string message(const std::string& address, const values& v)
    {
        return net::osc_packet(address, v);
    }
    /// A bundle for `unix_ns`.
    static std::string bundle(std::int64_t unix_ns, const std::vector<std::string>& messages)
    {
        constexpr std::uint64_t from_1900 = 2'208'988'800;
        const auto ns = static_cast<std::uint64_t>(unix_ns);
        const std::uint64_t fraction = ((ns % 1'000'000'000U << 32U) + 999'999'999U) / 1'000'000'000U;
        std::string b("#bundle\0", 8);
        const auto put = [&b](std::uint64_t n, unsigned bytes) {
            while (bytes-- != 0)
                b += static_cast<char>(n >> (8U * bytes) & 0xffU);
        };
        put(ns / 1'000'000'000U + from_1900, 4);
        put(fraction, 4);
        for (const std::string& m : messages) {
            put(m.size(), 4);
            b += m;
        }
        return b;
    }

    void say(const endpoint& from, const std::string& address, const values& v = {})
    {
        osc.receive(message(address, v), from);
    }
    /// Sends messages in a bundle for a time to come.
    void say_in(double seconds, const endpoint& from, const std::vector<std::string>& messages)
    {
        osc.receive(bundle(unix_ns() + static_cast<std::int64_t>(seconds * 1e9), messages), from);
    }
    /// The next message to somebody, in words: "/tactor/stroke 3 started".
    std::string next(const endpoint& to)
    {
        std::string found;
        until([&] {
            for (auto s = sent.begin(); s != sent.end(); ++s)
                if (s->first == to) {
                    found = s->second;
                    sent.erase(s);
                    return true;
                }
            return false;
        });
        return found;
    }
    /// Returns true if no message waits for an address once all present work is done.
    bool silent(const endpoint& to)
    {
        io.poll();
        return std::none_of(sent.begin(), sent.end(), [&](const auto& s) { return s.first == to; });
    }
    /// The clock goes on by so much, and what is due is done.
    void pass(double seconds)
    {
        passed_ns += static_cast<std::int64_t>(seconds * 1e9);
        osc.process_pending();
        io.poll();
    }
    std::int64_t unix_ns() const { return 1'800'000'000'000'000'000 + passed_ns; }

    static std::string words(const std::string& packet)
    {
        std::string all;
        for (const net::osc_message& m : net::parse_osc(packet)) {
            all += m.address;
            for (const net::osc_value& v : m.values) {
                all += ' ';
                if (const auto* n = std::get_if<std::int64_t>(&v))
                    all += std::to_string(*n);
                else if (const auto* x = std::get_if<double>(&v))
                    all += std::to_string(*x);
                else
                    all += std::get<std::string>(v);
            }
        }
        return all;
    }

    const std::int64_t began_ns = rt::monotonic_ns(); ///< the clock stands still but for pass()
    std::int64_t passed_ns = 0;
    std::int64_t jitter_ns = 0; ///< each reading of the clock is up to six times this early
    std::int64_t reads = 0;
    std::deque<std::pair<endpoint, std::string>> sent; ///< in words; next() takes one out
    server::osc_clients osc{
        io,
        *all,
        {[this](const endpoint& to, const std::string& packet) { sent.emplace_back(to, words(packet)); },
         [this] { return began_ns + passed_ns - jitter_ns * (++reads % 7); }, [this] { return unix_ns(); }}};
};

const osc_rig::endpoint me = osc_rig::at(9000);
const osc_rig::endpoint you = osc_rig::at(9001);

std::int64_t operator""_i(unsigned long long n)
{
    return static_cast<std::int64_t>(n);
}

const std::string drawing = "M 0 0 L 40 40";

// A live stroke, which waits for its first point as long as it is let.
osc_rig::values endless(std::int64_t number)
{
    return {number, "timeout_s=86400"s};
}

} // namespace

TEST_CASE("a stroke is reported by the sender's number, and then no sender is left")
{
    osc_rig rig;
    rig.say(me, "/tactor/play", {7_i, drawing, "duration=0.1"s, "algorithm=continuous"s});
    CHECK(rig.osc.count() == 1);
    CHECK(rig.next(me) == "/tactor/stroke 7 started");
    CHECK(rig.next(me) == "/tactor/stroke 7 finished");
    rig.say(me, "/tactor/play", {drawing, "duration=0.1"s});
    CHECK(rig.next(me) == "/tactor/stroke 0 started");
    CHECK(rig.next(me) == "/tactor/stroke 0 finished");
    rig.say(me, "/tactor/drive", {4_i, 0.5, 0.05});
    CHECK(rig.next(me) == "/tactor/stroke 0 started");
    CHECK(rig.next(me) == "/tactor/stroke 0 finished");
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
    const auto c = rig.client();
    CHECK(rig.ok(c, "status")["clients"] == 1);
}

TEST_CASE("a sender is among those who are there, by its address")
{
    osc_rig rig;
    rig.say(rig.at(9000, "::ffff:192.168.1.7"), "/tactor/begin", endless(1));
    CHECK(rig.all->status_json()["who"].front()["from"] == "192.168.1.7");
}

TEST_CASE("numbers belong to an address with its port")
{
    osc_rig rig;
    rig.say(me, "/tactor/begin", endless(1));
    rig.say(you, "/tactor/begin", endless(1));
    rig.say(me, "/tactor/begin", endless(1));
    CHECK(has(rig.next(me), "/tactor/error /tactor/begin number: stroke 1 is still playing"));
    rig.say(me, "/tactor/play", {1_i, drawing});
    CHECK(has(rig.next(me), "/tactor/error /tactor/play number: stroke 1 is still playing"));
    rig.say(osc_rig::at(9000, "127.0.0.2"), "/tactor/cancel", {1_i});
    CHECK(has(rig.next(osc_rig::at(9000, "127.0.0.2")), "this sender has no stroke 1"));
    rig.say(you, "/tactor/cancel", {1_i});
    CHECK(rig.next(you) == "/tactor/stroke 1 cancelled");
    CHECK(rig.silent(me));
    rig.say(you, "/tactor/begin", endless(1)); // free again
    rig.say(osc_rig::at(9), "/tactor/stop");   // of somebody who has drawn nothing
    CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
    CHECK(rig.next(you) == "/tactor/stroke 1 cancelled");
    CHECK(rig.silent(me));
}

TEST_CASE("a stop stops in whatever form it comes, but a button's release does not")
{
    osc_rig rig;
    const auto packet = [](const std::string& types, const std::string& data) {
        return "/tactor/stop\0\0\0\0"s + types + data;
    };
    for (const std::string& stop :
         {packet(",i\0\0"s, "\0\0\0\1"s), packet(",f\0\0"s, "\x3f\x80\0\0"s), packet(",T\0\0"s, ""),
          packet(",N\0\0"s, ""), packet(",I\0\0"s, ""), packet(",s\0\0"s, "\0\0\0\0"s),
          packet(",c\0\0"s, "\0\0\0\0"s), packet(",b\0\0"s, "\0\0\0\0"s),
          packet(",[i]\0\0\0\0"s, "\0\0\0\1"s), packet("", ""), "/tactor/stop"s, packet(",i\0\0"s, ""),
          packet(",?\0\0"s, ""), packet("ii\0\0"s, "\0\0\0\1"s),
          osc_rig::bundle(rig.unix_ns() + 100'000'000'000, {packet(",T\0\0"s, "")})}) {
        CAPTURE(stop);
        rig.say(me, "/tactor/begin", endless(1));
        rig.osc.receive(stop, you);
        CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
        CHECK(rig.silent(you));
    }
    // Beside a message that cannot be read.
    rig.say(me, "/tactor/begin", endless(1));
    rig.osc.receive(osc_rig::bundle(1, {"/tactor/end\0,?\0\0"s, packet(",?\0\0"s, "")}), you);
    CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
    CHECK(has(rig.next(you), "/tactor/error /tactor/end values: "));
    rig.say(me, "/tactor/begin", endless(1));
    rig.osc.receive(packet(",F\0\0"s, ""), you);
    rig.say(you, "/tactor/stop", {0_i});
    rig.say(you, "/tactor/stop", {0.0});
    CHECK(rig.silent(me));
    CHECK(rig.silent(you));
    rig.osc.receive(packet(",T\0\0"s, ""), me); // one's own
    CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
}

TEST_CASE("a live stroke in one packet, before its own number is known to anybody")
{
    osc_rig rig([](auto&, auto& s) { s.times.idle_stop_s = 0.001; });
    rig.sleep_and_plug();
    // The stream has to start first: the points wait.
    rig.osc.receive(osc_rig::bundle(0, {rig.message("/tactor/begin", endless(5)),
                                        rig.message("/tactor/to", {5_i, 20_i, 20.0}),
                                        rig.message("/tactor/to", {5_i, 21_i, 20.0, 0.5})}),
                    me);
    CHECK(rig.next(me) == "/tactor/stroke 5 started");
    rig.say(me, "/tactor/to", {5_i, 1e9, 0.0});
    CHECK(has(rig.next(me), "/tactor/error /tactor/to stroke 5: x_mm: 1000000000 is out of range"));
    rig.say(me, "/tactor/to", {5_i, 20.0, 20.0, 80.0});
    CHECK(has(rig.next(me), "/tactor/error /tactor/to stroke 5: an intensity of 80 plays as 1"));
    rig.say(me, "/tactor/to", {5_i, 20.0, 20.0, 2.0}); // said once
    rig.say(me, "/tactor/end", {5_i});
    CHECK(rig.next(me) == "/tactor/stroke 5 finished");
    rig.say(me, "/tactor/to", {5_i, 0.0, 0.0});
    CHECK(has(rig.next(me), "no stroke 5"));
}

TEST_CASE("faults are reported with the address and the number")
{
    osc_rig rig;
    rig.say(me, "/tactor/play", {3_i, "circel"s});
    CHECK(has(rig.next(me), "/tactor/error /tactor/play stroke 3: stroke: "));
    rig.say(me, "/tactor/play", {drawing, "level_dbfs=0"s});
    CHECK(has(rig.next(me),
              "/tactor/error /tactor/play options.level_dbfs: 0 dBFS is above the owner's limit of"));
    rig.say(me, "/tactor/begin", {3_i, "algorithm=brush"s});
    CHECK(has(rig.next(me), "/tactor/error /tactor/begin stroke 3: options.algorithm: "));
    rig.say(me, "/tactor/drive", {9_i, 1.0});
    CHECK(has(rig.next(me), "/tactor/error /tactor/drive tactor: "));
    rig.say(me, "/tactor/nonsense");
    CHECK(has(rig.next(me), "/tactor/error /tactor/nonsense address: it is unknown"));
    rig.osc.receive("rubbish!", me);
    CHECK(has(rig.next(me), "/tactor/error  message: its address does not begin with /"));
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
}

TEST_CASE("without a card strokes are refused, and subscribers hear of the stream")
{
    osc_rig rig;
    rig.unplug();
    rig.until([&] { return rig.all->output().is_unavailable(); });
    rig.say(me, "/tactor/play", {1_i, drawing});
    CHECK(has(rig.next(me), "stroke 1: stream: "));
    rig.say(me, "/tactor/subscribe", {9100_i, "stream"s});
    rig.plug();
    CHECK(rig.next(osc_rig::at(9100)) == "/tactor/stream running");
    rig.unplug();
    CHECK(rig.next(osc_rig::at(9100)) == "/tactor/stream lost");
}

TEST_CASE("levels come for ten seconds, and on if that is renewed")
{
    osc_rig rig;
    rig.say(me, "/tactor/subscribe", {"levels"s});
    CHECK(has(rig.next(me), "/tactor/levels -200.000000 -200.000000"));
    CHECK(rig.osc.next_ns().has_value());
    rig.pass(9.0);
    rig.say(me, "/tactor/subscribe", {"levels"s});
    rig.pass(9.0);
    CHECK(rig.osc.count() == 1);
    rig.pass(1.5);
    CHECK(rig.osc.count() == 0);
    CHECK_FALSE(rig.osc.next_ns().has_value());
    rig.say(me, "/tactor/subscribe", {"levels"s});
    rig.say(me, "/tactor/subscribe"); // ends it
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
    CHECK_FALSE(rig.osc.next_ns().has_value());
}

TEST_CASE("what is no beginning acts at once, whatever the time of its bundle is")
{
    osc_rig rig;
    rig.say(me, "/tactor/begin", endless(1));
    rig.say_in(2.0, me, {rig.message("/tactor/to", {1_i, 20.0, 20.0})});
    CHECK(rig.next(me) == "/tactor/stroke 1 started");
    rig.say_in(1.0, me, {rig.message("/tactor/to", {1_i, 1e9, 0.0})});
    CHECK(has(rig.next(me), "x_mm: 1000000000 is out of range"));
    rig.say_in(2.0, me, {rig.message("/tactor/end", {1_i})});
    CHECK(rig.next(me) == "/tactor/stroke 1 finished");
    rig.say(me, "/tactor/begin", endless(2));
    rig.say_in(1.0, me, {rig.message("/tactor/cancel", {2_i})});
    CHECK(rig.next(me) == "/tactor/stroke 2 cancelled");
    // A stop takes along what waits for its time.
    rig.say(me, "/tactor/begin", endless(3));
    rig.say_in(30.0, me, {rig.message("/tactor/begin", {4_i}), rig.message("/tactor/stop", {})});
    CHECK(rig.next(me) == "/tactor/stroke 4 cancelled");
    CHECK(rig.next(me) == "/tactor/stroke 3 cancelled");
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
    CHECK_FALSE(rig.osc.next_ns().has_value());
}

TEST_CASE("messages of one packet, and of several, act in the order in which they were sent")
{
    osc_rig rig;
    rig.jitter_ns = 1000;
    for (std::int32_t n = 1; n <= 20; ++n) {
        rig.say(me, "/tactor/begin", endless(n));
        const std::string to = rig.message("/tactor/to", {std::int64_t{n}, 1.0, 1.0});
        const std::string end = rig.message("/tactor/end", {std::int64_t{n}});
        if (n % 2 == 0) {
            rig.osc.receive(osc_rig::bundle(1, {to, to, to, end}), me);
        } else {
            rig.osc.receive(osc_rig::bundle(1, {to, to}), me);
            rig.osc.receive(to, me);
            rig.osc.receive(end, me);
        }
        CHECK(has(rig.next(me), " started"));
        CHECK(has(rig.next(me), " finished")); // a place that came after it would be an error
        CHECK(rig.silent(me));
    }
}

TEST_CASE("a live stroke with a time begins then, at the last place before")
{
    osc_rig rig;
    rig.say_in(1.0, me, {rig.message("/tactor/begin", endless(1))});
    for (int i = 0; i < 1000; ++i)
        rig.say(me, "/tactor/to", {1_i, i == 999 ? 20.0 : 1e9, 20.0});
    const auto& s = rig.all->output().setup();
    const double lead_s = (s.buffer_frames - 0.5 * s.period_frames) / s.rate;
    CHECK(lead_s > 0.0);
    rig.pass(1.0 - lead_s - 0.001);
    CHECK(rig.silent(me));
    rig.pass(0.002);
    CHECK(rig.next(me) == "/tactor/stroke 1 started");
    CHECK(rig.silent(me)); // nothing is wrong with the place
    rig.say(me, "/tactor/end", {1_i});
    CHECK(rig.next(me) == "/tactor/stroke 1 finished");
    // Cancelled before it began.
    rig.say_in(1.0, me, {rig.message("/tactor/begin", {1_i}), rig.message("/tactor/to", {1_i, 2.0, 2.0})});
    rig.say(me, "/tactor/cancel", {1_i});
    CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
    rig.pass(2.0);
    CHECK(rig.silent(me));
    CHECK(rig.osc.count() == 0);
}

TEST_CASE("what waits for its time when the server ends has its end, too")
{
    osc_rig rig;
    rig.say_in(30.0, me, {rig.message("/tactor/begin", {3_i})});
    CHECK(rig.silent(me));
    rig.osc.drop_held_strokes();
    CHECK(rig.next(me) == "/tactor/stroke 3 cancelled");
    CHECK_FALSE(rig.osc.next_ns());
}

TEST_CASE("no time is more than a minute ahead")
{
    osc_rig rig;
    rig.say_in(61.0, me, {rig.message("/tactor/begin", {1_i})});
    CHECK(has(rig.next(me), "/tactor/error /tactor/begin time tag: it is 61.0 s ahead (send it at most 60"));
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
    rig.say_in(60.0, me, {rig.message("/tactor/begin", {1_i})});
    CHECK(rig.silent(me));
    CHECK(rig.osc.count() == 1);
    rig.say(me, "/tactor/cancel", {1_i});
    CHECK(rig.next(me) == "/tactor/stroke 1 cancelled");
}

TEST_CASE("ten errors a second are sent")
{
    osc_rig rig;
    for (std::uint16_t port = 1; port <= 100; ++port)
        rig.say(osc_rig::at(port), "/tactor/nonsense");
    CHECK(rig.sent.size() == 10);
    rig.pass(0.999);
    rig.say(me, "/tactor/nonsense");
    CHECK(rig.sent.size() == 10);
    rig.pass(0.001);
    for (int i = 0; i < 100; ++i)
        rig.say(me, "/tactor/nonsense");
    CHECK(rig.sent.size() == 20);
    CHECK(rig.osc.count() == 0);
}

TEST_CASE("what a server sends is never answered")
{
    osc_rig rig;
    for (const char* own : {"/tactor/stroke", "/tactor/error", "/tactor/levels", "/tactor/stream"})
        rig.say(me, own, {1_i, "started"s});
    CHECK(rig.silent(me));
    CHECK(rig.osc.count() == 0);
    rig.say(me, "/tactor/stroke/"); // another address
    CHECK(has(rig.next(me), "address: it is unknown"));
}

TEST_CASE("what one sender may keep waiting has an end")
{
    osc_rig rig;
    const auto begin = [&](std::size_t n) {
        rig.say_in(30.0, me, {rig.message("/tactor/begin", endless(static_cast<std::int64_t>(n)))});
    };
    for (std::size_t i = 1; i <= server::osc_clients::most_held; ++i)
        begin(i);
    CHECK(rig.silent(me));
    begin(server::osc_clients::most_held + 1);
    CHECK(has(rig.next(me), "/tactor/error /tactor/begin strokes: too many strokes wait for their time"));
    rig.say(me, "/tactor/stop");
    CHECK_FALSE(rig.osc.next_ns().has_value());
}

TEST_CASE("touches of an avatar of VRChat are live strokes, and its other values get no answer")
{
    osc_rig rig([](auto& o, auto&) { o.limits.max_live_strokes = 2; });
    const auto avatar = rig.at(9001);
    const auto strokes = [&] { return rig.all->status_json()["strokes"].size(); };
    rig.say(avatar, "/avatar/parameters/bOSC_v1_VestFront_0", {0.5});
    rig.say(avatar, "/avatar/parameters/bOSC/v2/VestFront/19", {std::int64_t{1}});
    CHECK(rig.next(avatar).ends_with("started"));
    CHECK(rig.next(avatar).ends_with("started"));
    CHECK(strokes() == 2);
    // A touch that goes on is no other stroke.
    rig.say(avatar, "/avatar/parameters/bOSC_v1_VestFront_0", {0.7});
    rig.io.poll();
    CHECK(strokes() == 2);
    for (const char* other :
         {"/avatar/change", "/avatar/parameters/GestureLeft", "/avatar/parameters/bOSC",
          "/avatar/parameters/bOSC_v1_VestFront_20", "/avatar/parameters/bOSC_v1_VestBack_3",
          "/avatar/parameters/bOSC_v1_VestFront_-1", "/avatar/", "/avatar/parameters/bOSC__"})
        rig.say(avatar, other, {1.0});
    CHECK(rig.silent(avatar));
    CHECK(strokes() == 2);
    // The limit of live strokes.
    rig.say(avatar, "/avatar/parameters/bOSC_v1_VestFront_7", {1.0});
    CHECK(has(rig.next(avatar), "you have 2 live strokes already"));
    CHECK(rig.silent(avatar)); // one error, not another for its place
    for (const char* motor : {"bOSC_v1_VestFront_0", "bOSC/v2/VestFront/19"})
        rig.say(avatar, "/avatar/parameters/"s + motor, {0.0});
    CHECK(rig.next(avatar).ends_with("finished"));
    CHECK(rig.next(avatar).ends_with("finished"));
    rig.say(avatar, "/avatar/parameters/bOSC_v1_VestFront_0", {0.0});
    rig.io.poll();
    CHECK(rig.osc.count() == 0);
}

TEST_CASE("places are for those of whom something goes on")
{
    osc_rig rig([](auto& o, auto&) {
        o.limits.max_clients = 12; // a quarter of them for senders of OSC
        o.limits.kept_clients = 0;
    });
    for (std::uint16_t port = 1; port <= 3; ++port)
        rig.say(osc_rig::at(port), "/tactor/begin", endless(1));
    rig.say(me, "/tactor/begin", endless(1));
    CHECK(has(rig.next(me), "/tactor/error /tactor/begin max_clients: "));
    // Sockets and OSC senders do not take each other's places.
    std::vector<service_rig::connected> sockets;
    for (int i = 0; i < 12; ++i) {
        REQUIRE(rig.all->clients().has_free_place(server::client_kind::network));
        sockets.push_back(rig.client(server::client_kind::network));
    }
    CHECK_FALSE(rig.all->clients().has_free_place(server::client_kind::network));
    rig.say(me, "/tactor/stop"); // needs none
    for (std::uint16_t port = 1; port <= 3; ++port)
        CHECK(rig.next(osc_rig::at(port)) == "/tactor/stroke 1 cancelled");
}

} // namespace osc_clients_test
