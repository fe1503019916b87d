// SPDX-License-Identifier: MIT
// Drafts of plans: only the newest that waits is planned.
#include <atomic>
#include <future>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "service_rig.hpp"

namespace drafts_test {

using namespace tactor;
using namespace tactor::test;

namespace {

const json small{{"path", "M 0 0 L 40 40"}, {"options", {{"duration", 0.5}}}};
const json large{{"path", "M 0 0 L 40 40"}, {"options", {{"duration", 10}, {"algorithm", "continuous"}}}};

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
    void plan(const service_rig::connected& c, int id, const json& params)
    {
        rig.send(c, {{"jsonrpc", "2.0"}, {"id", id}, {"method", "plan"}, {"params", params}});
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
        rig.until([&] { return c.box->reply(id).has_value(); });
        REQUIRE_MESSAGE(c.box->reply(id)->contains("result"), c.box->reply(id)->dump());
        return (*c.box->reply(id))["result"];
    }

    std::promise<void> may_go_on;
    std::shared_future<void> gone_on{may_go_on.get_future()};
    std::atomic<int> full_plans{0};
    bool open = false;
    service_rig rig;
};

} // namespace

TEST_CASE("of a client's drafts that wait only the newest is planned")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    const auto you = s.rig.client();
    s.plan(other, 900, small); // which holds the planner
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
    s.result(other, 900);
    // A draft that nothing outdates.
    s.plan(me, 8, with_draft(small, 0, 0.9));
    CHECK(s.result(me, 8)["strokes"][0]["duration_s"] == 0.9);
}

TEST_CASE("a newer draft takes the turn of the one before")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    s.plan(other, 900, small);
    s.plan(me, 1, with_draft(small, 1, 0.3));
    const auto last = s.rig.client();
    s.plan(last, 901, with_draft(small, 1, 0.3));
    s.plan(me, 2, with_draft(small, 2, 0.4));
    s.go_on();
    s.result(last, 901);
    CHECK(me.box->reply(2).has_value());
}

TEST_CASE("a draft passes the plans of others, and after each one of these comes")
{
    held_service s;
    const auto other = s.rig.client();
    s.plan(other, 900, small);
    std::vector<service_rig::connected> planning;
    std::vector<service_rig::connected> drafting;
    for (int i = 0; i < 4; ++i) {
        planning.push_back(s.rig.client());
        s.plan(planning.back(), 901, small);
    }
    for (int i = 0; i < 3; ++i) {
        drafting.push_back(s.rig.client());
        s.plan(drafting.back(), 901, with_draft(small, 1, 0.3));
    }
    s.go_on();
    std::string order;
    const auto look = [&](std::vector<service_rig::connected>& all, char name) {
        if (!all.empty() && all.front().box->reply(901)) {
            all.erase(all.begin());
            order += name;
        }
    };
    while (order.size() < 7) {
        s.rig.io.run_one();
        look(planning, 'p');
        look(drafting, 'd');
    }
    CHECK(order == "dpdpdpp");
}

TEST_CASE("drafts in all lanes: one that waits with larger ones is outdated, too")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    s.plan(other, 900, large);
    s.rig.ok(other, "plan", with_draft(small, 0, 0.1)); // the large one is with the large ones now
    s.plan(me, 901, with_draft(large, 1, 10.0));
    s.rig.ok(me, "plan", [&] {
        json peaks = small;
        peaks["view"] = "peaks";
        return peaks;
    }());
    CHECK_FALSE(me.box->reply(901)); // it waits behind the other
    s.plan(me, 902, with_draft(large, 2, 9.0));
    CHECK(held_service::is_outdated(me, 901));
    s.plan(me, 903, with_draft(small, 3, 0.3));
    CHECK(held_service::is_outdated(me, 902));
    s.go_on();
    CHECK(s.result(me, 903)["strokes"][0]["duration_s"] == 0.3);
}

TEST_CASE("a draft with a long text does not take the turn of a short one")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    s.plan(other, 900, small);
    s.plan(me, 1, with_draft(small, 1, 0.3));
    json points = json::array();
    for (int i = 0; i < 2000; ++i)
        points.push_back({i * 1e-3, 20, 20});
    const json drawn{{"points", points}, {"view", "bursts"}, {"draft", 2}};
    s.plan(me, 2, drawn);
    CHECK(held_service::is_outdated(me, 1));
    CHECK(s.result(me, 2)["strokes"][0]["duration_s"] == 1.999); // though the planner of short ones is held
    CHECK_FALSE(other.box->reply(900));
}

TEST_CASE("drafts in one batch: the first is outdated, and the batch is answered")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    s.plan(other, 900, small);
    json batch = json::array();
    for (int i = 1; i <= 2; ++i)
        batch.push_back(
            {{"jsonrpc", "2.0"}, {"id", i}, {"method", "plan"}, {"params", with_draft(small, i, 0.1 * i)}});
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
        l.max_clients = 2;
        l.max_strokes = 2;
        l.max_all_unread_bytes = 8000;
    });
    const auto other = s.rig.client();
    s.plan(other, 900, small);
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
    s.result(other, 900);
    s.rig.ok(other, "plan", small);
    CHECK(s.full_plans == 2); // nobody reads the plans of those that went
    CHECK(s.rig.ok(other, "status")["strokes"].empty());
    // The stream may rest again: nothing is coming.
    const json n = s.rig.ok(other, "play", {{"stroke", "park2016-1"}})["stroke"];
    CHECK(s.rig.find_end(other, n)["state"] == "finished");
}

TEST_CASE("waiting drafts are refused when the server ends")
{
    held_service s;
    const auto other = s.rig.client();
    const auto me = s.rig.client();
    s.plan(other, 900, small);
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
