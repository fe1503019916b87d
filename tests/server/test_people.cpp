// SPDX-License-Identifier: MIT
// Clients that know of each other: who is there, touches and stops.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "service_rig.hpp"

namespace people_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr std::int64_t second = 1'000'000'000;

// A service whose clock the test turns, and two clients: one draws, one looks on.
class touch_rig : public service_rig {
public:
    touch_rig()
        : service_rig([this](server::service_options& o, server::stream_options&) {
              o.now_ns = [this] { return now_ns; };
              o.limits.max_points_per_s = 1e6;
          })
    {
        plug();
        start();
        ok(looks, "subscribe", {{"events", {"touches"}}});
    }
    json begin() { return ok(draws, "begin", {{"timeout_s", 86400}})["stroke"]; }
    void move(const json& stroke, double x)
    {
        ok(draws, "to", {{"stroke", stroke}, {"x_mm", x}, {"y_mm", 20}});
    }
    void end(const json& stroke)
    {
        ok(draws, "end", {{"stroke", stroke}});
        find_end(draws, stroke);
    }
    json touch(const json& stroke, double x, bool down) const
    {
        return {{"client", draws.number}, {"stroke", stroke}, {"x_mm", x}, {"y_mm", 20.0}, {"down", down}};
    }
    std::vector<json> seen() const { return looks.box->notifications("touches"); }

    std::int64_t now_ns = second;
    connected draws = client();
    connected looks = client();
};

} // namespace

TEST_CASE("a client has a number, and the name that it gives, for others to see")
{
    service_rig rig;
    const auto a = rig.client();
    const auto b = rig.client(server::client_kind::web);
    CHECK(rig.ok(a, "hello")["client"] == a.number);
    CHECK(rig.ok(b, "hello", {{"name", "Ann"}})["client"] == b.number);
    const json who = rig.ok(a, "status")["who"];
    CHECK(who == json::array({{{"client", a.number}, {"name", ""}, {"from", "this computer"}},
                              {{"client", b.number}, {"name", "Ann"}, {"from", "192.168.1.7"}}}));
    rig.ok(b, "hello"); // says no name: the last one holds
    CHECK(rig.ok(a, "status")["who"] == who);
    rig.ok(b, "hello", {{"name", "Bob"}});
    CHECK(rig.ok(a, "status")["who"][1]["name"] == "Bob");
    rig.all->disconnect(b.number);
    CHECK(rig.ok(a, "status")["who"].size() == 1);
}

TEST_CASE("a name that could spoil what others read is refused, and the last one holds")
{
    service_rig rig;
    const auto a = rig.client();
    rig.ok(a, "hello", {{"name", "Ann"}});
    for (const json& bad :
         {json(""), json(std::string(41, 'x')), json("a\nb"), json("a\x1b[2J"), json(7), json(nullptr),
          json(" "), json("\u00a0"), json("\u2003"), json("\u00ad"), json("\u3164"), json("\u2800"),
          json("the\u2003owner"), json("yo\u00adu"), json("you\u200b"), json("you"), json("You"),
          json("the owner"), json("The Owner ")}) { // the last ones pages give themselves
        const json r = rig.call(a, "hello", {{"name", bad}});
        REQUIRE(r.contains("error"));
        CHECK(r["error"]["code"] == -32602);
        CHECK(r["error"]["data"]["what"] == "name");
    }
    CHECK(rig.ok(a, "status")["who"][0]["name"] == "Ann");
    CHECK(rig.code(a, "hello", {{"name", "Youna"}}) == 0);
}

TEST_CASE("a client without the right token gives no name")
{
    service_rig rig([](server::service_options& o, server::stream_options&) { o.token = "secret"; });
    const auto owner = rig.client();
    const auto a = rig.client(server::client_kind::web);
    CHECK(rig.code(a, "hello", {{"name", "Ann"}, {"token", "guess"}}) == -32003);
    CHECK(rig.ok(owner, "status")["who"][1]["name"] == "");
    rig.ok(a, "hello", {{"name", "Ann"}, {"token", "secret"}});
    CHECK(rig.ok(owner, "status")["who"][1]["name"] == "Ann");
}

TEST_CASE("others see each place of a live stroke and its end, its owner does not")
{
    touch_rig rig;
    rig.ok(rig.draws, "subscribe", {{"events", {"touches"}}});
    const json n = rig.begin();
    CHECK(rig.seen().empty()); // it is nowhere yet
    rig.move(n, 1.0);
    rig.now_ns += second / 30;
    rig.move(n, 2.0);
    rig.end(n);
    CHECK(rig.seen() ==
          std::vector{rig.touch(n, 1.0, true), rig.touch(n, 2.0, true), rig.touch(n, 2.0, false)});
    CHECK(rig.draws.box->notifications("touches").empty());
    rig.ok(rig.looks, "subscribe", {{"events", json::array()}});
    const json other = rig.begin();
    rig.move(other, 1.0);
    rig.end(other);
    CHECK(rig.seen().size() == 3);
}

TEST_CASE("a stroke is shown 30 times a second at most, and never less than where it rests")
{
    touch_rig rig;
    const json n = rig.begin();
    for (int i = 0; i < 1000; ++i) {
        rig.move(n, 0.01 * i);
        rig.now_ns += second / 1000;
    }
    const std::size_t in_a_second = rig.seen().size();
    CHECK(in_a_second <= 31); // the first one at its very start
    CHECK(in_a_second >= 29);
    rig.until([&] { // the finger rests
        rig.now_ns += second / 30;
        return rig.seen().back() == rig.touch(n, 9.99, true);
    });
    const std::size_t then = rig.seen().size();
    CHECK(then <= in_a_second + 1);
    rig.end(n);
    CHECK(rig.seen().back() == rig.touch(n, 9.99, false));
    CHECK(rig.seen().size() == then + 1);
}

TEST_CASE("a stroke that was nowhere ends unseen, one of a client that goes away is seen to end")
{
    touch_rig rig;
    rig.end(rig.begin());
    CHECK(rig.seen().empty());
    const json n = rig.begin();
    rig.move(n, 3.0);
    rig.all->disconnect(rig.draws.number);
    rig.until([&] { return rig.seen().size() == 2; });
    CHECK(rig.seen().back() == rig.touch(n, 3.0, false));
}

TEST_CASE("a client that is behind sees no touches and no stops until it has caught up")
{
    touch_rig rig;
    rig.ok(rig.looks, "subscribe", {{"events", {"touches", "stops"}}});
    const json n = rig.begin();
    rig.looks.box->unread = std::size_t{64} << 10;
    rig.move(n, 1.0);
    rig.ok(rig.draws, "stop");
    rig.find_end(rig.draws, n);
    CHECK(rig.seen().empty());
    CHECK(rig.looks.box->notifications("stops").empty());
    rig.looks.box->unread = 0;
    const json next = rig.begin();
    rig.move(next, 2.0);
    rig.ok(rig.draws, "stop");
    CHECK(rig.seen().front() == rig.touch(next, 2.0, true));
    CHECK(rig.looks.box->notifications("stops").size() == 1);
}

TEST_CASE("many who draw before many share 10000 touches a second")
{
    touch_rig rig;
    std::vector<service_rig::connected> crowd;
    for (int i = 0; i < 99; ++i) {
        crowd.push_back(rig.client());
        rig.ok(crowd.back(), "subscribe", {{"events", {"touches"}}});
    }
    std::vector<json> strokes;
    for (const auto& c : crowd)
        for (int i = 0; i < 4; ++i)
            strokes.push_back(rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"]);
    const std::size_t before = rig.seen().size();
    for (std::size_t i = 0; i < strokes.size(); ++i)
        rig.ok(crowd[i / 4], "to", {{"stroke", strokes[i]}, {"x_mm", 20}, {"y_mm", 20}});
    CHECK(rig.seen().size() - before == 100); // of 396, to 100 clients each
}

TEST_CASE("everybody who asks learns who stopped everything")
{
    running_rig rig;
    const auto a = rig.client();
    const auto b = rig.client();
    rig.ok(a, "hello", {{"name", "Ann"}});
    for (const auto& c : {a, b})
        rig.ok(c, "subscribe", {{"events", {"stops"}}});
    rig.ok(a, "stop");
    rig.ok(b, "stop");
    const std::vector<json> told{{{"client", a.number}, {"name", "Ann"}},
                                 {{"client", b.number}, {"name", ""}}};
    CHECK(a.box->notifications("stops") == told);
    CHECK(b.box->notifications("stops") == told);
    rig.ok(b, "subscribe", {{"events", json::array()}});
    rig.close();
    CHECK(a.box->notifications("stops").back() == json{{"client", 0}, {"name", ""}});
    CHECK(b.box->notifications("stops") == told);
}

} // namespace people_test
