// SPDX-License-Identifier: MIT
// Imports and exports among the other requests of the service.
#include <atomic>
#include <string>

#include <doctest/doctest.h>

#include "net/rpc.hpp"
#include "server/files.hpp"
#include "service_rig.hpp"

namespace service_files_test {

using namespace tactor;
using namespace tactor::test;

namespace {

json ask_sound(double seconds)
{
    return {{"path", "M 0 0 L 40 40"}, {"as", "wav"}, {"options", {{"duration", seconds}}}};
}

json export_request(int id, double seconds)
{
    return service_rig::request(id, "export", ask_sound(seconds));
}

} // namespace

TEST_CASE("files are made without a device, and in batches")
{
    service_rig rig;
    rig.start();
    const auto c = rig.client();
    CHECK(rig.code(c, "play", {{"path", "M 0 0 L 40 40"}}) == net::code_no_stream);
    const json sound = rig.ok(c, "export", ask_sound(0.5));
    const auto bytes = net::decode_base64(sound["base64"].get<std::string>());
    REQUIRE(bytes);
    CHECK(bytes->starts_with("RIFF"));
    CHECK(rig.ok(c, "import", {{"stroke", "circle"}})["strokes"].size() == 1);
    rig.send(c, json::array({export_request(71, 0.1), export_request(72, 10.0), export_request(73, 0.1)}));
    rig.until([&] { return !c.box->all.empty() && c.box->all.back().is_array(); });
    const json& all = c.box->all.back();
    REQUIRE(all.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(all[i]["id"] == 71 + static_cast<int>(i));
        CHECK(all[i].contains("result"));
    }
}

TEST_CASE("a second file is refused while the first one is not read")
{
    running_rig rig;
    const auto c = rig.client();
    c.box->file_bytes_unread = 1;
    const json r = rig.call(c, "export", ask_sound(1.0));
    CHECK(r["error"]["code"] == net::code_limit);
    CHECK(r["error"]["data"]["what"] == "max_unread_bytes");
    CHECK(rig.code(c, "plan", {{"path", "M 0 0 L 40 40"}}) == 0);
    c.box->file_bytes_unread = 0;
    CHECK(rig.code(c, "export", ask_sound(1.0)) == 0);
    // The files of all clients have 96 MiB together, but a file alone is always made.
    const auto other = rig.client();
    other.box->file_bytes_unread = 95U << 20U;
    CHECK(rig.code(c, "export", ask_sound(0.1)) == 0);
    CHECK(rig.code(c, "export", ask_sound(1.0)) == net::code_limit);
}

TEST_CASE("files for a client that left are not made, and its strokes are played")
{
    std::atomic<int> made = 0;
    running_rig rig([&](server::service_options& o, server::stream_options&) {
        o.plan_text = [&made](const server::planned&, std::size_t) {
            ++made;
            return std::string("{}");
        };
    });
    const auto a = rig.client();
    const auto b = rig.client();
    rig.ok(b, "subscribe", {{"events", {"strokes"}}});
    json plan = export_request(1, 0.5);
    plan["params"]["as"] = "json";
    for (int i = 0; i < 30; ++i)
        rig.send(a, plan);
    rig.send(a, rig.request(99, "play", {{"path", "M 0 0 L 40 40"}, {"options", {{"duration", 0.1}}}}));
    rig.all->disconnect(a.number);
    rig.find_end(b, 1);
    rig.close();
    CHECK(a.box->all.empty());
    CHECK(made <= 1); // what was being made
}

TEST_CASE("the end of the server refuses files that wait")
{
    running_rig rig;
    const auto c = rig.client();
    for (int i = 1; i <= 10; ++i)
        rig.send(c, export_request(i, 20.0));
    rig.close();
    CHECK(rig.reply(c, 10)["error"]["code"] == net::code_no_stream);
}

TEST_CASE("names of files are letters, digits, blanks, - and _")
{
    using server::make_file_name;
    for (const char* name : {"a", "a b_c-1", "Kr\u00e4ftig \u7dda", "0"})
        CHECK(make_file_name(name) == name);
    for (const char* name :
         {"", "-a", " a", "a ", "a/b", "..", "a.b", "a\nb", "a\x7f", "a\u0085", "a\u202egpj"}) {
        CAPTURE(name);
        CHECK(make_file_name(name) != name);
        CHECK(make_file_name(make_file_name(name)) == make_file_name(name));
    }
    CHECK(make_file_name("../../etc/passwd") == "______etc_passwd");
    CHECK(make_file_name("") == "stroke");
    CHECK(make_file_name(" ") == "_");
    CHECK(make_file_name(std::string(99, 'x') + "\u7dda") == std::string(99, 'x'));
}

} // namespace service_files_test
