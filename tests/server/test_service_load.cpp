// SPDX-License-Identifier: MIT
// Many clients at once: each request has its reply, each stroke its end. What depends on the machine's time
// is measured by tests/bench/serve_load.py.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "service_rig.hpp"

namespace service_load_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr int clients = 100;
constexpr int rounds = 20;
constexpr int drawing = 12; // of them, in each round
constexpr int points = 42;

/// A client: its requests, and its messages.
struct asker {
    service_rig::connected link;
    int asked = 0;
    std::vector<int> began = {}; ///< requests that begin a stroke

    void ask(service_rig& rig, const char* method, const json& params)
    {
        rig.send(link, {{"jsonrpc", "2.0"}, {"id", ++asked}, {"method", method}, {"params", params}});
    }
    void play(service_rig& rig)
    {
        ask(rig, "play",
            {{"path", "M 0 0 L 40 40"},
             {"options", {{"algorithm", "continuous"}, {"duration", 0.1}, {"level_dbfs", -40}}}});
        began.push_back(asked);
    }
    json stroke_number(int request) const { return (*link.box->reply(request))["result"]["stroke"]; }
    bool replied() const { return link.box->reply(asked).has_value(); }
    bool settled() const
    {
        return replied() && std::all_of(began.begin(), began.end(), [&](int request) {
                   return link.box->reply(request) && link.box->find_end(stroke_number(request));
               });
    }
};

} // namespace

TEST_CASE("a hundred clients at once: each request has one reply, each stroke one end, nothing is left")
{
    running_rig rig;
    std::vector<asker> all;
    for (int i = 0; i < clients; ++i)
        all.push_back({rig.client()});
    std::map<std::string, int> ends;
    for (int round = 0; round < rounds; ++round) {
        for (asker& a : all) {
            a.link.box->all.clear();
            a.began.clear();
            a.play(rig);
        }
        for (int i = 0; i < drawing; ++i) {
            asker& a = all[static_cast<std::size_t>((round * drawing + i) % clients)];
            a.ask(rig, "begin", {{"timeout_s", 86400}, {"options", {{"level_dbfs", -40}}}});
            a.began.push_back(a.asked);
            rig.until([&] { return a.replied(); });
            for (int k = 0; k < points; ++k)
                a.ask(rig, "to",
                      {{"stroke", a.stroke_number(a.began.back())}, {"x_mm", k % 41}, {"y_mm", 7 * k % 41}});
            a.ask(rig, "end", {{"stroke", a.stroke_number(a.began.back())}});
        }
        auto next = all.begin();
        rig.until([&] {
            while (next != all.end() && next->settled())
                ++next;
            return next == all.end();
        });
        for (const asker& a : all) {
            std::map<int, int> replies;
            for (const json& m : a.link.box->all) {
                if (m.contains("id")) {
                    ++replies[m["id"]];
                    CHECK_MESSAGE(m.contains("result"), m.dump());
                } else if (m["method"] == "stroke" && m["params"]["state"] != "started") {
                    ++ends[m["params"]["stroke"].dump()];
                    CHECK(m["params"]["state"] == "finished");
                }
            }
            for (const auto& [id, n] : replies)
                CHECK(n == 1);
            CHECK(replies.rbegin()->first == a.asked);
        }
    }
    CHECK(ends.size() == rounds * (clients + drawing));
    for (const auto& [number, n] : ends)
        CHECK(n == 1);
    const json now = rig.ok(all.front().link, "status");
    CHECK(now["strokes"].empty());
    CHECK(now["clients"] == clients);
    CHECK(now["stream"]["xruns"] == 0);
}

} // namespace service_load_test
