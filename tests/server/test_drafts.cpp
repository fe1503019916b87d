// SPDX-License-Identifier: MIT
// Drafts of plans: only the newest that waits is planned.
#include <array>
#include <atomic>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "service_rig.hpp"

namespace drafts_test {

using namespace tactor;
using namespace tactor::test;

namespace {

const json small{{"path", "M 0 0 L 40 40"}, {"options", {{"duration", 0.5}}}};

json with_draft(json params, double number, double duration_s)
{
    params["view"] = "percept";
    params["draft"] = number;
    params["options"]["duration"] = duration_s;
    return params;
}

/// A service whose planners wait in each full plan until they may go on.
struct held_service {
    explicit held_service(const std::function<void(server::service_limits&)>& limit = {})
        : rig([&](server::service_options& o, server::stream_options&) {
              if (limit)
                  limit(o.limits);
              o.plan_text = [this](const server::planned&, std::size_t) {
                  ++full_plans;
                  gone_on.wait();
                  return std::string("{}");
              };
          })
    {
        rig.plug();
        rig.start();
    }
    ~held_service() { go_on(); }

    void go_on()
    {
        if (!open)
            may_go_on.set_value();
        open = true;
    }
    /// Holds the planner of drafts.
    void hold_drafts()
    {
        json draft = small;
        draft["draft"] = 0;
        plan(holding.back(), 900, draft);
    }
    /// Holds both planners.
    void hold()
    {
        hold_drafts();
        plan(holding.front(), 900, small);
        while (full_plans != 2)
            std::this_thread::yield();
    }
    void plan(const service_rig::connected& c, int id, const json& params)
    {
        rig.send(c, rig.request(id, "plan", params));
    }
    /// Returns true if a request has the answer that it is outdated.
    static bool is_outdated(const service_rig::connected& c, int id)
    {
        const auto r = c.box->reply(id);
        if (!r || !r->contains("error"))
            return false;
        CHECK((*r)["error"]["code"] == -32001);
        const json& data = (*r)["error"]["data"];
        CHECK(data["kind"] == "limit");
        CHECK(data["what"] == "draft");
        return data["why"] == "outdated";
    }
    /// Waits for the result of a request.
    json result(const service_rig::connected& c, int id)
    {
        const json r = rig.reply(c, id);
        REQUIRE_MESSAGE(r.contains("result"), r.dump());
        return r["result"];
    }

    std::promise<void> may_go_on;
    std::shared_future<void> gone_on{may_go_on.get_future()};
    std::atomic<int> full_plans{0};
    bool open = false;
    service_rig rig;
    std::array<service_rig::connected, 2> holding{rig.client(), rig.client()};
};

} // namespace

TEST_CASE("of a client's drafts that wait only the newest is planned")
{
    held_service s;
    const auto me = s.rig.client();
    const auto you = s.rig.client();
    s.hold();
    s.plan(you, 901, with_draft(small, 1, 0.3));
    s.plan(me, 902, small); // no draft
    for (int i = 1; i <= 5; ++i) {
        s.plan(me, i, with_draft(small, i, 0.1 * i));
        CHECK(held_service::is_outdated(me, i - 1) == (i > 1));
    }
    s.plan(me, 6, with_draft(small, 3, 0.7)); // older than the one that waits
    CHECK(held_service::is_outdated(me, 6));
    s.plan(me, 7, with_draft(small, 5, 0.8)); // as old
    CHECK(held_service::is_outdated(me, 5));
    CHECK_FALSE(me.box->reply(7));
    s.go_on();
    CHECK(s.result(me, 7)["strokes"][0]["duration_s"] == 0.8);
    CHECK(s.result(you, 901)["strokes"][0]["duration_s"] == 0.3);
    CHECK(s.result(me, 902) == json::object());
    // A draft that nothing outdates.
    s.plan(me, 8, with_draft(small, 0, 0.9));
    CHECK(s.result(me, 8)["strokes"][0]["duration_s"] == 0.9);
}

TEST_CASE("clients have turns, and a draft passes what is its own client's")
{
    held_service s;
    s.hold_drafts(); // one planner is left
    const auto many = s.rig.client();
    const auto one = s.rig.client();
    json view = small;
    view["view"] = "bursts";
    for (int i = 1; i <= 3; ++i)
        s.plan(many, i, view);
    s.plan(many, 4, with_draft(small, 1, 0.3));
    s.plan(one, 5, with_draft(small, 1, 0.3));
    std::vector<int> order;
    while (order.size() != 5) {
        const std::size_t before = many.box->all.size() + one.box->all.size();
        s.rig.until([&] { return many.box->all.size() + one.box->all.size() != before; });
        const bool is_one = order.size() == 2;
        order.push_back((is_one ? one : many).box->all.back()["id"]);
    }
    CHECK(order == std::vector<int>{1, 4, 5, 2, 3});
}

TEST_CASE("drafts in one batch: the first is outdated, and the batch is answered")
{
    held_service s;
    const auto me = s.rig.client();
    s.hold();
    json batch = json::array();
    for (int i = 1; i <= 2; ++i)
        batch.push_back(service_rig::request(i, "plan", with_draft(small, i, 0.1 * i)));
    s.rig.send(me, batch);
    CHECK(me.box->all.empty());
    s.go_on();
    s.rig.until([&] { return !me.box->all.empty(); });
    CHECK(me.box->all[0][0]["error"]["data"]["why"] == "outdated");
    CHECK(me.box->all[0][1]["result"]["strokes"][0]["duration_s"] == 0.2);
}

TEST_CASE("a dropped draft, and one whose client goes, count for no limit any more")
{
    held_service s([](server::service_limits& l) {
        l.max_clients = 4;
        l.max_strokes = 2;
    });
    s.hold();
    for (int round = 0; round < 10; ++round) {
        const auto me = s.rig.client();
        for (int i = 1; i <= 10; ++i) {
            s.plan(me, i, with_draft(small, i, 0.3));
            CHECK(held_service::is_outdated(me, i - 1) == (i > 1));
        }
        CHECK_FALSE(me.box->reply(10));
        s.plan(me, 11, small); // a second one; a third is too many
        s.plan(me, 12, small);
        CHECK((*me.box->reply(12))["error"]["data"]["what"] == "max_strokes");
        s.rig.all->disconnect(me.number);
        CHECK_FALSE(me.box->reply(10));
        CHECK_FALSE(me.box->reply(11));
    }
    s.go_on();
    const auto& other = s.holding.front();
    s.result(other, 900);
    s.rig.ok(other, "plan", small);
    CHECK(s.full_plans == 3); // nobody reads the plans of those that went
    CHECK(s.rig.ok(other, "status")["strokes"].empty());
    // The stream may rest again: nothing is coming.
    const json n = s.rig.ok(other, "play", {{"stroke", "park2016-1"}})["stroke"];
    CHECK(s.rig.find_end(other, n)["state"] == "finished");
}

TEST_CASE("waiting drafts are refused when the server ends")
{
    held_service s;
    const auto me = s.rig.client();
    s.hold();
    s.plan(me, 1, with_draft(small, 1, 0.3));
    s.rig.close();
    CHECK((*me.box->reply(1))["error"]["code"] == -32000);
}

TEST_CASE("the number of a draft is whole, and play has none")
{
    running_rig rig;
    const auto c = rig.client();
    for (const json& number : {json(-1), json(1.5), json("1"), json(nullptr)}) {
        json params = small;
        params["draft"] = number;
        CHECK(rig.call(c, "plan", params)["error"]["data"]["what"] == "draft");
    }
    CHECK(rig.call(c, "play", with_draft(small, 1, 0.3))["error"]["code"] == -32602);
    for (const char* name : {"view", "draft", "bins", "observer"}) {
        json params = small;
        params[name] = "percept";
        CHECK(rig.call(c, "play", params)["error"]["data"]["what"] == name);
    }
}

} // namespace drafts_test
