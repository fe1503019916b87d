// SPDX-License-Identifier: MIT
// Clients that know of each other: who is there.
#include <doctest/doctest.h>

#include <string>

#include "service_rig.hpp"

namespace people_test {

using namespace tactor;
using namespace tactor::test;

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
         {json(""), json(std::string(41, 'x')), json("a\nb"), json("a\x1b[2J"), json(7), json(nullptr)}) {
        const json r = rig.call(a, "hello", {{"name", bad}});
        REQUIRE(r.contains("error"));
        CHECK(r["error"]["code"] == -32602);
        CHECK(r["error"]["data"]["what"] == "name");
    }
    CHECK(rig.ok(a, "status")["who"][0]["name"] == "Ann");
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

} // namespace people_test
