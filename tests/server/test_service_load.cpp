// SPDX-License-Identifier: MIT
// Many clients at once: each request has its reply, each stroke its end. What depends on the machine's time
// is measured by tests/bench/serve_load.py.
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "service_rig.hpp"

namespace service_load_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("a hundred clients at once: each request has one reply, each stroke one end, nothing is left")
{
    constexpr std::size_t clients = 100;
    constexpr std::size_t drawing = 12; // of them, in each round
    const json brief{{"path", "M 0 0 L 40 40"},
                     {"options", {{"algorithm", "continuous"}, {"duration", 0.1}, {"level_dbfs", -40}}}};
    running_rig rig;
    std::vector<service_rig::connected> all;
    for (std::size_t i = 0; i < clients; ++i)
        all.push_back(rig.client());
    int asked = 1'000'000; // rig.ok() counts from 1
    const auto ask = [&](const service_rig::connected& c, const char* method, const json& params) {
        rig.send(c, {{"jsonrpc", "2.0"}, {"id", ++asked}, {"method", method}, {"params", params}});
        return asked;
    };
    for (std::size_t round = 0; round < 20; ++round) {
        std::vector<int> plays;
        std::vector<int> last;
        std::vector<std::vector<json>> strokes(clients);
        for (const auto& c : all) {
            c.box->all.clear();
            plays.push_back(ask(c, "play", brief));
            last.push_back(plays.back());
        }
        for (std::size_t i = 0; i < drawing; ++i) {
            const std::size_t who = (round * drawing + i) % clients;
            const json options{{"timeout_s", 86400}, {"options", {{"level_dbfs", -40}}}};
            const json n = rig.ok(all[who], "begin", options)["stroke"];
            strokes[who].push_back(n);
            for (int k = 0; k < 42; ++k)
                ask(all[who], "to", {{"stroke", n}, {"x_mm", k % 41}, {"y_mm", 7 * k % 41}});
            last[who] = ask(all[who], "end", {{"stroke", n}});
        }
        for (std::size_t i = 0; i < clients; ++i) {
            const inbox& box = *all[i].box;
            rig.until([&] { return box.reply(plays[i]) && box.reply(last[i]); });
            strokes[i].push_back((*box.reply(plays[i]))["result"]["stroke"]);
            for (const json& n : strokes[i]) {
                CHECK(rig.find_end(all[i], n)["state"] == "finished");
                CHECK(box.stroke_messages(n).size() == 2); // its start, and its end
            }
        }
        for (const auto& c : all) {
            std::set<int> replies;
            for (const json& m : c.box->all)
                if (m.contains("id")) {
                    CHECK_MESSAGE(m.contains("result"), m.dump());
                    CHECK(replies.insert(m["id"].get<int>()).second);
                }
        }
    }
    const json now = rig.ok(all.front(), "status");
    CHECK(now["strokes"].empty());
    CHECK(now["clients"] == clients);
    CHECK(now["stream"]["xruns"] == 0);
}

} // namespace service_load_test
