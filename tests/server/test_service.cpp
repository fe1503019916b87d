// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>
#include <thread>

#include <doctest/doctest.h>

#include "rounds.hpp"
#include "service_rig.hpp"

// Many clients at once: tests/bench/serve_load.py, which is in the suite.
namespace service_test {

using namespace tactor;
using namespace tactor::test;

namespace {

const json stroke{{"path", "M 0 0 L 40 40"}, {"options", {{"algorithm", "continuous"}, {"duration", 0.1}}}};

json with(json params, const char* name, const json& value)
{
    params[name] = value;
    return params;
}

double find_peak(const fake_dac& card)
{
    const auto bytes = card.captured();
    double most = 0.0;
    for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
        std::int32_t v = 0;
        std::memcpy(&v, bytes.data() + i, sizeof v);
        most = std::max(most, std::abs(static_cast<double>(v)) / 2147483648.0);
    }
    return 20.0 * std::log10(most);
}

} // namespace

TEST_CASE("a stroke: the reply, its beginning, its end, each once and in this order")
{
    running_rig rig;
    const auto c = rig.client();
    const json n = rig.ok(c, "play", stroke)["stroke"];
    CHECK(c.box->stroke_messages(n).empty()); // none came before the reply
    const json end = rig.find_end(c, n);
    CHECK(end["state"] == "finished");
    CHECK(end["frames"] == 4800);
    const auto told = c.box->stroke_messages(n);
    REQUIRE(told.size() == 2);
    CHECK(told[0]["state"] == "started");
    CHECK(told[0]["frames"] == 0);
    CHECK(told[0]["started_s"].is_number());
}

TEST_CASE("a batch's reply comes before reports of its strokes")
{
    running_rig rig;
    const auto c = rig.client();
    json batch = json::array();
    for (int i = 0; i < 20; ++i)
        batch.push_back(rig.request(1000 + i, "play", stroke));
    rig.send(c, batch);
    rig.until([&] { return !c.box->all.empty(); });
    REQUIRE(c.box->all.front().is_array());
    std::set<int> numbers;
    for (const json& r : c.box->all.front())
        numbers.insert(r["result"]["stroke"].get<int>());
    CHECK(numbers.size() == 20);
    for (const int n : numbers)
        CHECK(rig.find_end(c, n)["state"] == "finished");
}

TEST_CASE("all clients together stay below the ceiling on every channel")
{
    service_rig rig;
    rig.captures = running_clock::capture_kind::kept;
    fake_dac& card = rig.plug();
    rig.start();
    const auto a = rig.client();
    const auto b = rig.client();
    const json x = rig.ok(a, "drive", {{"tactor", 4}, {"duration_s", 0.2}})["stroke"];
    const json y = rig.ok(b, "drive", {{"tactor", 4}, {"duration_s", 0.2}})["stroke"];
    const json live = rig.ok(b, "begin", {{"timeout_s", 86400}})["stroke"];
    const json loud{{"stroke", live}, {"x_mm", 20}, {"y_mm", 20}, {"intensity", 1000}};
    CHECK(rig.ok(b, "to", loud).empty());
    CHECK(rig.ok(b, "to", loud).empty());
    CHECK(rig.ok(b, "to", {{"stroke", live}, {"x_mm", 640}, {"y_mm", 20}}).empty());
    rig.find_end(a, x);
    rig.find_end(b, y);
    rig.ok(b, "end", {{"stroke", live}});
    const json end = rig.find_end(b, live);
    CHECK(end["held_points"] == 2);
    CHECK(end["outside_points"] == 1);
    CHECK(find_peak(card) <= -12.0 + 0.01);
    CHECK(find_peak(card) > -12.5);
}

TEST_CASE("other people's strokes are not touched, but stop is everybody's")
{
    running_rig rig;
    const auto a = rig.client();
    const auto b = rig.client();
    const json n = rig.ok(a, "play", with(stroke, "start", "armed"))["stroke"];
    CHECK(rig.code(b, "cancel", {{"stroke", n}}) == -32002);
    CHECK(rig.code(b, "end", {{"stroke", n}}) == -32002);
    CHECK(rig.code(a, "end", {{"stroke", n}}) == -32002); // it is not live
    CHECK(rig.ok(b, "stop").empty());
    CHECK(rig.find_end(a, n)["state"] == "cancelled");
    CHECK(b.box->stroke_messages(n).empty());
    CHECK(rig.ok(b, "fire")["count"] == 0);
}

TEST_CASE("the reason of an end says who ended it")
{
    running_rig rig;
    const auto a = rig.client();
    const auto b = rig.client();
    const json armed = with(stroke, "start", "armed");
    const json several{{"toml", "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 1\n[[stroke]]\npath = 'M 0 "
                                "0 L 0 40'\nduration_s = 1\n"},
                       {"start", "armed"}};
    const auto reason = [&](const json& n) { return rig.find_end(a, n)["reason"]; };
    const json own = rig.ok(a, "play", armed)["stroke"];
    rig.ok(a, "cancel", {{"stroke", own}});
    CHECK(reason(own) == "cancelled by its client");
    const json file = rig.ok(a, "play", several)["strokes"];
    rig.ok(a, "cancel", {{"stroke", file[0]}});
    CHECK(reason(file[0]) == "cancelled by its client");
    CHECK(reason(file[1]) == "cancelled by its client"); // which was to follow
    const json mine = rig.ok(a, "play", several)["strokes"];
    const json live = rig.ok(a, "begin", {{"timeout_s", 86400}})["stroke"];
    rig.ok(a, "stop");
    for (const json& n : {mine[0], mine[1], live})
        CHECK(reason(n) == "cancelled by its client");
    const json theirs = rig.ok(a, "play", several)["strokes"];
    const json lively = rig.ok(a, "begin", {{"timeout_s", 86400}})["stroke"];
    rig.ok(b, "stop");
    rig.ok(a, "stop"); // too late to be the reason
    for (const json& n : {theirs[0], theirs[1], lively})
        CHECK(reason(n) == "stopped by another client");
    const json ends = rig.ok(a, "play", stroke)["stroke"];
    CHECK(reason(ends) == "");
    const json starved = rig.ok(a, "begin", {{"timeout_s", 0.001}})["stroke"];
    CHECK(reason(starved) == "no more points came");
    const json lost = rig.ok(a, "begin", {{"timeout_s", 86400}})["stroke"];
    rig.ok(a, "to", {{"stroke", lost}, {"x_mm", 20}, {"y_mm", 20}});
    rig.until([&] { return !a.box->stroke_messages(lost).empty(); });
    rig.unplug();
    CHECK(reason(lost) == "device: the device is gone");
    rig.plug();
    rig.until([&] { return rig.all->output().state() == server::stream_state::running; });
    const json last = rig.ok(a, "play", armed)["stroke"];
    rig.close();
    CHECK(reason(last) == "stopped by the owner");
}

TEST_CASE("a stroke handed over twice, as after an xrun before it sounds, is reported to start once")
{
    service_rig rig;
    fake_dac& card = rig.plug();
    rig.start();
    const auto c = rig.client();
    rig.clocks.clear(); // time stands still
    const json n = rig.ok(c, "play", with(stroke, "start", {{"delay_s", 0.4}}))["stroke"];
    // Its first frame lies far ahead, but it has been handed over.
    while (c.box->stroke_messages(n).empty()) {
        card.advance_queued(1);
        rig.io.poll();
        std::this_thread::yield();
    }
    card.advance(1'000'000); // an xrun
    rig.clocks.emplace_back(card, running_clock::capture_kind::dropped);
    CHECK(rig.find_end(c, n)["state"] == "finished");
    CHECK(c.box->stroke_messages(n).size() == 2); // that it started, and that it ended
    CHECK(rig.ok(c, "status")["stream"]["xruns"] == 1);
}

TEST_CASE("a large message is read on another thread, and answered as a small one")
{
    running_rig rig;
    const auto c = rig.client();
    json points = json::array();
    for (int i = 0; i < 1000; ++i)
        points.push_back({i * 1e-4, 20, 20});
    std::vector<bool> done;
    const auto large = [&](const std::string& text) {
        rig.all->receive_large_message(c.number, text, [&](bool go_on) { done.push_back(go_on); });
        const std::size_t before = done.size();
        rig.until([&] { return done.size() != before; });
    };
    large(rig.request(900, "play", {{"points", points}, {"start", "armed"}}).dump());
    const json n = rig.reply(c, 900)["result"]["stroke"];
    CHECK(rig.ok(c, "fire")["count"] == 1);
    CHECK(rig.find_end(c, n)["state"] == "finished");
    const std::string noise(10'000, 'x');
    large(noise);
    CHECK(c.box->all.back()["error"]["code"] == -32700);
    CHECK(c.box->all.back().dump().size() < 1000); // what it repeats is cut
    large(rig.request(901, noise, {{noise, noise}}).dump());
    CHECK((*c.box->reply(901))["error"]["code"] == -32601);
    CHECK(c.box->all.back().dump().size() < 1500);
    CHECK(done == std::vector{true, true, true});
    const auto stranger = rig.client(server::client_kind::network);
    rig.all->receive_large_message(stranger.number, noise, [&](bool go_on) { done.push_back(go_on); });
    rig.until([&] { return done.size() == 4; });
    CHECK_FALSE(done.back()); // no hello
}

TEST_CASE("one tactor alone has a start, too")
{
    running_rig rig;
    const auto c = rig.client();
    const json drive{{"tactor", 4}, {"duration_s", 0.05}};
    const json n = rig.ok(c, "drive", with(drive, "start", "armed"))["stroke"];
    CHECK(rig.ok(c, "status")["strokes"][0]["state"] == "armed");
    CHECK(rig.ok(c, "fire")["count"] == 1);
    CHECK(rig.find_end(c, n)["state"] == "finished");
    CHECK(rig.call(c, "drive", with(drive, "start", "soon"))["error"]["data"]["what"] == "start");
    CHECK(rig.call(c, "drive", with(drive, "start", {{"delay_s", -1}}))["error"]["data"]["what"] ==
          "start.delay_s");
}

TEST_CASE("stop ends all strokes of an armed file, also when the first has begun unseen")
{
    for (const bool fired : {false, true}) {
        CAPTURE(fired);
        running_rig rig;
        const auto c = rig.client();
        const char* const two = "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 500\n"
                                "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 1\n";
        const json numbers = rig.ok(
            c, "play",
            {{"toml", two}, {"start", "armed"}, {"options", {{"algorithm", "tactile-brush"}}}})["strokes"];
        if (fired) {
            rig.ok(c, "fire");
            while (!rig.all->output().current()->position().stroke) // the service handles nothing meanwhile
                std::this_thread::yield();
        }
        rig.ok(c, "stop");
        for (const json& n : numbers)
            CHECK(rig.find_end(c, n)["reason"] == "cancelled by its client");
        CHECK(c.box->stroke_messages(numbers[1]).size() == 1);
        rig.until([&] { return rig.ok(c, "status")["strokes"].empty(); });
    }
}

TEST_CASE("a stop in a batch that is refused stops all the same, and one that nests too deep is accepted")
{
    running_rig rig;
    const auto a = rig.client();
    const auto b = rig.client();
    json batch = json::array();
    for (int i = 0; i < 100; ++i)
        batch.push_back({{"jsonrpc", "2.0"}, {"method", "status"}});
    batch[70] = {{"method", "stop"}};
    json deep = 1;
    for (int i = 0; i < 99; ++i)
        deep = json::array({deep});
    for (const json& message : {batch, json{{"method", "stop"}, {"id", 5}, {"params", deep}}}) {
        const json n = rig.ok(a, "play", with(stroke, "start", "armed"))["stroke"];
        b.box->all.clear();
        rig.send(b, message);
        CHECK(rig.find_end(a, n)["reason"] == "stopped by another client");
        if (message.is_array())
            CHECK(b.box->all.front()["error"]["code"] == -32001);
        else
            CHECK(b.box->all.front()["result"] == json::object());
    }
    // Like any request: not before the token.
    running_rig locked([](server::service_options& o, server::stream_options&) { o.token = "secret"; });
    const auto owner = locked.client();
    const auto stranger = locked.client(server::client_kind::web);
    const json n = locked.ok(owner, "play", with(stroke, "start", "armed"))["stroke"];
    locked.send(stranger, batch);
    CHECK(stranger.box->all.size() == 1);
    CHECK(locked.ok(owner, "status")["strokes"].size() == 1);
    CHECK(locked.ok(owner, "cancel", {{"stroke", n}}).empty());
}

TEST_CASE("cancel of all ends strokes being planned, even of a client that has gone, and only its own")
{
    running_rig rig;
    const auto me = rig.client();
    const auto you = rig.client();
    rig.ok(you, "subscribe", {{"events", {"strokes"}}});
    const json yours = rig.ok(you, "play", with(stroke, "start", "armed"))["stroke"];
    const json armed = rig.ok(me, "play", with(stroke, "start", "armed"))["stroke"];
    const json live = rig.ok(me, "begin", {{"timeout_s", 86400}})["stroke"];
    const json cancel = rig.request(1001, "cancel", {{"all", true}});
    rig.send(me, rig.request(1000, "play", stroke));
    rig.send(me, cancel);
    for (const json& n : {armed, live})
        CHECK(rig.find_end(me, n)["reason"] == "cancelled by its client");
    const json end = rig.find_end(me, rig.reply(me, 1000)["result"]["stroke"]);
    CHECK((*me.box->reply(1001))["result"] == json::object());
    CHECK(end["state"] == "cancelled");
    CHECK(end["reason"] == "cancelled by its client");
    CHECK(end["frames"] == 0);
    // Later strokes play, by the next number.
    const json next = rig.ok(me, "play", stroke)["stroke"];
    CHECK(next == end["stroke"].get<unsigned>() + 1);
    CHECK(rig.find_end(me, next)["state"] == "finished");
    you.box->all.clear();
    rig.send(me, rig.request(1002, "play", stroke));
    rig.send(me, cancel);
    rig.all->disconnect(me.number);
    const auto ended = [&] {
        return std::any_of(you.box->all.begin(), you.box->all.end(),
                           [](const json& m) { return m.contains("method"); });
    };
    rig.until(ended);
    CHECK(you.box->all.front()["params"]["state"] == "cancelled");
    CHECK(rig.ok(you, "cancel", {{"stroke", yours}}).empty());
    for (const json& params :
         {json{{"all", false}}, json{{"all", 1}}, json{{"all", true}, {"stroke", 1}}, json::object()})
        CHECK(rig.code(you, "cancel", params) == -32602);
}

TEST_CASE("a QR code of a text is that of the program qrencode")
{
    running_rig rig;
    const auto me = rig.client();
    const json small = rig.ok(me, "qr", {{"text", "tactor 4cc71bb"}});
    CHECK(small["size"] == 21);
    const std::string path = small["path"];
    CHECK(path.starts_with("M0 0h1v1h-1zM1 0h1v1h-1zM2 0h1v1h-1z"));
    CHECK(path.size() == 2975);
    CHECK(rig.ok(me, "qr", {{"text", std::string(400, 'a')}})["size"] == 69);
    for (const json& params : {json::object(), json{{"text", ""}}, json{{"text", std::string(401, 'a')}},
                               json{{"text", 7}}, json{{"text", "a"}, {"level", "H"}}})
        CHECK(rig.code(me, "qr", params) == -32602);
}

TEST_CASE("a client's level holds for its strokes that sound and that come, and for no others")
{
    running_rig rig;
    const auto me = rig.client();
    const auto you = rig.client();
    const json stroke{{"stroke", "park2016-1"}, {"options", {{"duration", 5}}}};
    const json mine = rig.ok(me, "play", stroke)["stroke"];
    CHECK(rig.ok(me, "level", {{"db", -20}}).empty());
    CHECK(rig.ok(me, "level", {{"db", -3.5}, {"stroke", mine}}).empty());
    CHECK(rig.code(you, "level", {{"db", -6}, {"stroke", mine}}) == -32002);
    for (const json& params : {json::object(), json{{"db", 1}}, json{{"db", -61}}, json{{"db", "-6"}},
                               json{{"db", -6}, {"gain_db", 0}}})
        CHECK(rig.code(me, "level", params) == -32602);
    json weaker = stroke;
    weaker["gain_db"] = -6;
    CHECK(rig.ok(me, "play", weaker).contains("stroke"));
    weaker["gain_db"] = 0.5;
    CHECK(rig.code(me, "play", weaker) == -32602);
}

TEST_CASE("gain_db and the level of a client are what its strokes sound with, live ones too")
{
    const auto heard_db = [](const json& level, const json& gain, bool live) {
        service_rig rig;
        rig.captures = running_clock::capture_kind::kept;
        fake_dac& card = rig.plug();
        rig.start();
        const auto c = rig.client();
        if (!level.is_null())
            rig.ok(c, "level", {{"db", level}});
        json n;
        if (live) {
            rig.ok(c, "subscribe", {{"events", {"levels"}}}); // they come while it sounds
            n = rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"];
            rig.ok(c, "to", {{"stroke", n}, {"x_mm", 20}, {"y_mm", 20}});
            const std::uint64_t from = rig.all->output().stats().frames;
            rig.until([&] { return rig.all->output().stats().frames > from + 9600; });
            rig.ok(c, "end", {{"stroke", n}});
        } else {
            json params = stroke;
            if (!gain.is_null())
                params["gain_db"] = gain;
            n = rig.ok(c, "play", params)["stroke"];
        }
        CHECK(rig.find_end(c, n)["state"] == "finished");
        rig.clocks.clear();
        return find_peak(card);
    };
    CHECK(heard_db(nullptr, nullptr, false) == doctest::Approx(-12.0).epsilon(0.01));
    CHECK(heard_db(nullptr, -6, false) == doctest::Approx(-18.0).epsilon(0.01));
    CHECK(heard_db(-20, nullptr, false) == doctest::Approx(-32.0).epsilon(0.01));
    CHECK(heard_db(-20, -6, false) == doctest::Approx(-38.0).epsilon(0.01));
    CHECK(heard_db(nullptr, nullptr, true) == doctest::Approx(-12.0).epsilon(0.01));
    CHECK(heard_db(-20, nullptr, true) == doctest::Approx(-32.0).epsilon(0.01));
}

TEST_CASE("a stroke that repeats has one beginning and one end")
{
    running_rig rig;
    const auto c = rig.client();
    const json r = rig.ok(c, "play", with(stroke, "repeat", 3));
    CHECK(r["total_s"] == doctest::Approx(0.1));
    const json end = rig.find_end(c, r["stroke"]);
    CHECK(end["state"] == "finished");
    CHECK(end["frames"] == 3 * 4800);
    CHECK(c.box->stroke_messages(r["stroke"]).size() == 2);
    for (const json& wrong : {json(0), json(-1), json(1.5), json(false), json("3"), json(nullptr)})
        CHECK(rig.code(c, "play", with(stroke, "repeat", wrong)) == -32602);
    CHECK(rig.code(c, "play", with(stroke, "repeat", 1'000'000)) == -32001);
    const json instant{{"points", {{0, 20, 20}, {1e-9, 20, 20}}}, {"options", {{"algorithm", "continuous"}}}};
    CHECK(rig.code(c, "play", with(instant, "repeat", true)) == -32001);
    CHECK(rig.code(c, "plan", with(stroke, "repeat", 2)) == -32602);
}

// Under a sanitizer or emulation the clock may outrun a service this slow, so that its strokes end.
bool is_outrun(const char* name)
{
    if (shortened())
        std::printf("SKIPPED: %s: the clock outruns a service this slow\n", name);
    return shortened();
}

TEST_CASE("what repeats until it is cancelled has no gap")
{
    if (is_outrun("what repeats until it is cancelled"))
        return;
    service_rig rig;
    rig.captures = running_clock::capture_kind::kept;
    fake_dac& card = rig.plug();
    rig.start();
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"levels"}}});
    const json n = rig.ok(c, "play", with(stroke, "repeat", true))["stroke"];
    const std::uint64_t begun = rig.all->output().stats().frames;
    rig.until([&] { return rig.all->output().stats().frames > begun + 8 * 48000; });
    CHECK(rig.ok(c, "status")["strokes"].size() == 1);
    rig.ok(c, "cancel", {{"stroke", n}});
    const json end = rig.find_end(c, n);
    CHECK(end["state"] == "cancelled");
    CHECK(end["reason"] == "cancelled by its client");
    CHECK(end["frames"] > 7 * 48000);
    CHECK(c.box->stroke_messages(n).size() == 2);
    CHECK(rig.ok(c, "status")["strokes"].empty());
    rig.clocks.clear();
    const auto bytes = card.captured();
    constexpr std::size_t frame = 9 * 4;
    std::vector<std::size_t> sounds; // frames that are not silent
    for (std::size_t i = 0; i + frame <= bytes.size(); i += frame)
        if (std::any_of(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                        bytes.begin() + static_cast<std::ptrdiff_t>(i + frame),
                        [](std::byte b) { return b != std::byte{0}; }))
            sounds.push_back(i / frame);
    REQUIRE(sounds.size() > 7 * 48000);
    std::size_t longest = 0;
    for (std::size_t i = 1; i < sounds.size(); ++i)
        longest = std::max(longest, sounds[i] - sounds[i - 1]);
    CHECK(longest <= 2); // the first frame of a round is silent
}

TEST_CASE("what repeats ends with its client, and is not cut")
{
    if (is_outrun("what repeats ends with its client"))
        return;
    running_rig rig;
    const auto goes = rig.client();
    const auto looks = rig.client();
    rig.ok(looks, "subscribe", {{"events", {"strokes", "levels"}}});
    const json n = rig.ok(goes, "play", with(stroke, "repeat", true))["stroke"];
    rig.until([&] { return rig.all->output().stats().frames > 5 * 48000; });
    rig.all->disconnect(goes.number);
    const json end = rig.find_end(looks, n);
    CHECK(end["state"] == "finished");
    CHECK(end["frames"].get<std::uint64_t>() % 96000 == 0);
}

TEST_CASE("too many bursts are refused before they are planned, and a view for its own size")
{
    running_rig rig([](server::service_options& o, server::stream_options&) {
        o.plan_text = [](const server::planned&, std::size_t) -> std::string {
            throw std::logic_error("planned");
        };
    });
    const auto c = rig.client();
    const auto refused = [&](const char* method, const json& options) {
        const json e = rig.call(c, method, {{"path", "M 0 0 L 40 40"}, {"options", options}})["error"];
        CHECK(e["code"] == -32001);
        return e["data"]["what"].get<std::string>();
    };
    const json bursts{{"duration", 600}, {"soa", 0.001}, {"burst", 0.001}};
    CHECK(refused("play", bursts) == "bursts");
    CHECK(refused("plan", bursts) == "bursts");
    // The planner reports its refusals itself.
    for (const json& options :
         {json{{"duration", 600}, {"soa", 1e-7}, {"burst", 0.001}}, json{{"duration", 600}, {"soa", 0.001}}})
        CHECK(
            rig.call(c, "plan", {{"path", "M 0 0 L 40 40"}, {"options", options}})["error"]["data"]["what"] ==
            "options.soa");
    const json often{{"path", "M 0 0 L 1 1"},
                     {"options", {{"duration", 0.001}, {"soa", 0.0005}, {"burst", 0.0005}}},
                     {"repeat", 1'000'000}};
    CHECK(rig.call(c, "play", often)["error"]["data"]["what"] == "bursts");
    CHECK(rig.code(c, "plan",
                   {{"path", "M 0 0 L 40 40"},
                    {"options", {{"duration", 10}, {"algorithm", "continuous"}}}}) == -32603); // planned
    // A view is refused for its own size.
    const json dense{{"duration", 590}, {"soa", 0.004}, {"burst", 0.004}};
    const auto view = [&](const char* name) {
        const json params{{"path", "M 0 0 L 40 40"}, {"view", name}, {"options", dense}};
        return rig.call(c, "plan", params);
    };
    CHECK(view("bursts")["error"]["data"]["what"] == "plan");
    CHECK(view("peaks")["result"]["peaks"].size() == 3600);
    CHECK(rig.ok(c, "status")["strokes"].empty());
    // A continuous stroke takes no memory by its length, and a large request that is cancelled leaves
    // nothing.
    const json n = rig.ok(c, "play",
                          {{"path", "M 0 0 L 40 40"},
                           {"start", "armed"},
                           {"options", {{"duration", 600}, {"algorithm", "continuous"}}}})["stroke"];
    rig.ok(c, "cancel", {{"all", true}});
    CHECK(rig.find_end(c, n)["state"] == "cancelled");
}

TEST_CASE("smooth_s: an end waits until the last point is reached")
{
    running_rig rig;
    const auto c = rig.client();
    for (const json& bad : {json(-0.1), json(1.1), json("0.1")})
        CHECK(rig.call(c, "begin", {{"smooth_s", bad}})["error"]["data"]["what"] == "smooth_s");
    const json n = rig.ok(c, "begin", {{"timeout_s", 86400}, {"smooth_s", 0.5}})["stroke"];
    rig.ok(c, "to", {{"stroke", n}, {"x_mm", 1}, {"y_mm", 1}});
    // It has begun, and periods have gone by since.
    rig.until([&] { return !c.box->stroke_messages(n).empty(); });
    rig.find_end(c, rig.ok(c, "drive", {{"tactor", 8}, {"duration_s", 0.05}})["stroke"]);
    rig.ok(c, "to", {{"stroke", n}, {"x_mm", 39}, {"y_mm", 39}});
    rig.ok(c, "end", {{"stroke", n}});
    const json end = rig.find_end(c, n);
    CHECK(end["state"] == "finished");
    CHECK(end["frames"] >= 24'000);
}

TEST_CASE("who sends no more and waits for the end of a stroke takes no place, and there are so many of them")
{
    running_rig rig([](server::service_options& o, server::stream_options&) {
        o.limits.max_clients = 2;
        o.limits.kept_clients = 0;
    });
    std::vector<server::client_number> let_go;
    rig.all->clients().on_all_sent([&](server::client_number n) { let_go.push_back(n); });
    std::vector<service_rig::connected> gone;
    for (int i = 0; i < 3; ++i) {
        REQUIRE(rig.all->clients().has_free_place(server::client_kind::network));
        gone.push_back(rig.client());
        rig.ok(gone.back(), "play", {{"stroke", "park2016-1"}, {"start", "armed"}});
        CHECK_FALSE(rig.all->input_ended(gone.back().number));
    }
    CHECK(let_go == std::vector{gone.front().number});
    const auto last = rig.client();
    rig.ok(last, "stop");
    CHECK(rig.find_end(gone.back(), 3)["state"] == "cancelled");
}

TEST_CASE("many points and many strokes are refused, not queued")
{
    running_rig rig([](server::service_options& o, server::stream_options&) {
        o.now_ns = [] { return std::int64_t{1'000'000'000}; };
    });
    const auto c = rig.client();
    const json n = rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"];
    const json point{{"stroke", n}, {"x_mm", 1}, {"y_mm", 1}};
    for (int i = 0; i < 2000; ++i)
        REQUIRE(rig.code(c, "to", point) == 0);
    CHECK(rig.code(c, "to", point) == -32001);
    for (int i = 0; i < 3; ++i)
        rig.ok(c, "begin", {{"timeout_s", 86400}});
    CHECK(rig.code(c, "begin") == -32001);
    for (int i = 0; i < 60; ++i)
        rig.ok(c, "play", with(stroke, "start", "armed"));
    CHECK(rig.code(c, "play", stroke) == -32001);
    rig.ok(c, "stop");
    rig.until([&] { return rig.code(c, "play", stroke) == 0; });
}

TEST_CASE("max_stroke_s holds for live strokes, too, however many points come")
{
    running_rig rig([](server::service_options& o, server::stream_options&) { o.limits.max_stroke_s = 0.2; });
    const auto c = rig.client();
    const json n = rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"];
    const json point{
        {"jsonrpc", "2.0"}, {"method", "to"}, {"params", {{"stroke", n}, {"x_mm", 1}, {"y_mm", 1}}}};
    rig.send(c, point);
    const json end = rig.find_end(c, n);
    CHECK(end["state"] == "interrupted");
    CHECK(end["reason"] == "limit: it reached the longest allowed duration");
    CHECK(end["frames"] >= 9600);
    CHECK(end["frames"] <= 9600 + 2 * 480);
    CHECK(rig.ok(c, "status")["strokes"].empty());
    CHECK_FALSE(rig.ok(c, "begin").empty()); // its place is free
}

TEST_CASE("over a network hello comes first, and the token where one is owed")
{
    running_rig rig([](server::service_options& o, server::stream_options&) { o.token = "right"; });
    const auto post = rig.client(server::client_kind::network);
    CHECK_FALSE(rig.all->receive(post.number, "POST / HTTP/1.1"));
    CHECK(post.box->all.empty());
    const auto c = rig.client(server::client_kind::network);
    CHECK(rig.code(c, "hello") == -32003);
    CHECK(rig.code(c, "status") == -32003);
    CHECK(rig.code(c, "hello", {{"token", "wrong"}}) == -32003);
    CHECK_FALSE(c.box->finished);
    CHECK(rig.code(c, "hello", {{"token", "righ"}}) == -32003);
    CHECK(c.box->finished);
    const auto d = rig.client(server::client_kind::network);
    CHECK(rig.code(d, "hello", {{"token", "right"}}) == 0);
    CHECK(rig.code(d, "status") == 0);
    CHECK(rig.code(rig.client(), "status") == 0);
    // Sent before a wrong token is answered, the right one counts as wrong.
    const auto hasty = rig.client(server::client_kind::network);
    for (const char* token : {"wrong", "right"})
        rig.send(hasty, {{"jsonrpc", "2.0"}, {"id", 1}, {"method", "hello"}, {"params", {{"token", token}}}});
    CHECK(rig.code(hasty, "status") == -32003);
}

TEST_CASE("a client that owes its token stops nothing")
{
    running_rig rig([](server::service_options& o, server::stream_options&) { o.token = "right"; });
    const auto owner = rig.client();
    const json n = rig.ok(owner, "play", with(stroke, "start", "armed"))["stroke"];
    for (const server::client_kind k : {server::client_kind::web, server::client_kind::network}) {
        const auto guest = rig.client(k);
        rig.code(guest, "hello");
        CHECK(rig.code(guest, "stop") == -32003);
        rig.send(guest, {{"jsonrpc", "2.0"}, {"method", "stop"}});
        rig.send(guest, json::array({rig.request(90, "stop"), rig.request(91, "status")}));
        CHECK_FALSE(owner.box->find_end(n).has_value());
    }
    CHECK(rig.ok(owner, "fire")["count"] == 1);
    CHECK(rig.find_end(owner, n)["state"] == "finished");
}

TEST_CASE("the log names a stroke, its level and its client, and what is refused")
{
    std::vector<std::string> log;
    running_rig rig([&log](server::service_options& o, server::stream_options&) {
        o.token = "right";
        o.log = [&log](log_kind, std::string_view text) { log.emplace_back(text); };
    });
    const auto logged = [&](const std::string& begin) {
        return std::count_if(log.begin(), log.end(),
                             [&](const std::string& l) { return l.starts_with(begin); });
    };
    const auto a = rig.client(server::client_kind::web);
    CHECK(rig.code(a, "hello") == -32003);
    CHECK(logged("refused: no token from 192.168.1.7") == 1);
    CHECK(rig.code(a, "hello", {{"token", "left"}}) == -32003);
    CHECK(logged("refused: a wrong token from 192.168.1.7") == 1);
    rig.ok(a, "hello", {{"token", "right"}, {"name", "pad"}});
    const json quiet{{"stroke", "park2016-3"}, {"options", {{"level_dbfs", -24}}}, {"gain_db", -6}};
    rig.find_end(a, rig.ok(a, "play", quiet)["stroke"]);
    CHECK(logged("stroke 1 \"park2016-3\" at -30 dBFS of client 1 \"pad\" (192.168.1.7): began ") == 1);
    const auto b = rig.client();
    rig.ok(b, "level", {{"db", -3}});
    rig.find_end(b, rig.ok(b, "drive", {{"tactor", 4}, {"duration_s", 0.1}})["stroke"]);
    CHECK(logged("stroke 2 \"tactor 4\" at -15 dBFS of client 2 (this computer): began ") == 1);
    const json live =
        rig.ok(b, "begin", {{"timeout_s", 86400}, {"options", {{"level_dbfs", -20}}}})["stroke"];
    rig.ok(b, "end", {{"stroke", live}});
    rig.find_end(b, live);
    CHECK(logged("stroke 3 \"live\" at -23 dBFS of client 2 (this computer): ") == 1);
    const auto post = rig.client(server::client_kind::network);
    CHECK_FALSE(rig.all->receive(post.number, "POST / HTTP/1.1"));
    CHECK(logged("refused: a connection that does not begin with hello from 192.168.1.7") == 1);
}

TEST_CASE("what is nearly right is suggested, as by the tool")
{
    running_rig rig;
    const auto c = rig.client();
    const auto hint = [&](const char* method, const json& params) {
        return rig.call(c, method, params)["error"]["data"]["hint"].get<std::string>();
    };
    const auto meant = [&](const char* method, const json& params) {
        const std::string text = hint(method, params);
        const std::size_t from = text.find('\'') + 1;
        return text.starts_with("did you mean '") ? text.substr(from, text.find('\'', from) - from) : text;
    };
    CHECK(meant("plya", {}) == "play");
    CHECK(meant("play", {{"stroke", "park2016_3"}}) == "park2016-3");
    CHECK(meant("play", {{"strok", "park2016-3"}}) == "stroke");
    CHECK(meant("plan", with(stroke, "options", {{"level-dbfs", -20}})) == "level_dbfs");
    CHECK(meant("plan", with(stroke, "view", "burst")) == "bursts");
    CHECK(meant("subscribe", {{"events", {"stroke"}}}) == "strokes");
    CHECK(meant("export", {{"stroke", "park2016-1"}, {"as", "jsn"}}) == "json");
    CHECK(hint("plan", with(stroke, "options", {{"algorithm", "continous"}}))
              .starts_with("did you mean continuous?"));
    CHECK(hint("status", {{"x", 1}}) == "the method has no parameters");
}

} // namespace service_test
