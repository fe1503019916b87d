// SPDX-License-Identifier: MIT
// Cards that come and go, and the end.
#include <atomic>
#include <exception>
#include <future>
#include <memory>
#include <string>

#include <doctest/doctest.h>

#include "service_rig.hpp"

namespace service_faults_test {

using namespace tactor;
using namespace tactor::test;

namespace {

const json brief{{"path", "M 0 0 L 40 40"}, {"options", {{"algorithm", "continuous"}, {"duration", 0.1}}}};
const json armed{{"path", "M 0 0 L 40 40"}, {"start", "armed"}};

/// A card that cannot do what is asked of it, where `bad`.
struct misfit {
    void replace(server::stream_options& s)
    {
        s.open = [this, open = s.open] {
            ++tries;
            if (bad)
                throw error(error_kind::bad_input, "PCM", "it has two channels", "choose another");
            return open();
        };
        s.refused = [this](const std::exception_ptr&) { ++refused; };
    }

    std::atomic<bool> bad = false;
    std::atomic<int> tries = 0;
    int refused = 0; ///< the context's thread
};

/// The line of an amplifier that goes on and never off again.
class stuck_line final : public enable_line {
public:
    bool set(bool on) noexcept override { return on; }
};

} // namespace

TEST_CASE("no card at the start, then one, then another in its place")
{
    service_rig rig;
    rig.start();
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"stream"}}});
    rig.until([&] { return rig.all->output().is_unavailable(); });
    CHECK(rig.code(c, "play", brief) == -32000);
    CHECK(rig.code(c, "drive", {{"tactor", 0}}) == -32000);
    CHECK(rig.code(c, "begin") == -32000);
    CHECK(rig.code(c, "plan", brief) == 0);
    CHECK(rig.ok(c, "hello")["stream"]["format"].is_null());
    CHECK(rig.ok(c, "status")["stream"]["state"] == "lost");
    rig.plug();
    rig.until([&] { return rig.all->output().state() == server::stream_state::running; });
    CHECK(rig.ok(c, "hello")["stream"]["format"] == "s32");
    CHECK(rig.find_end(c, rig.ok(c, "play", brief)["stroke"])["state"] == "finished");

    const json played = rig.ok(c, "play", armed)["stroke"];
    const json live = rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"];
    rig.unplug();
    for (const json& n : {played, live}) {
        const json end = rig.find_end(c, n);
        CHECK(end["state"] == "interrupted");
        CHECK(end["reason"] != "");
    }
    rig.until([&] { return rig.all->output().state() == server::stream_state::lost; });
    CHECK(rig.code(c, "to", {{"stroke", live}, {"x_mm", 1}, {"y_mm", 1}}) == -32002);
    rig.plug();
    rig.until([&] { return rig.all->output().state() == server::stream_state::running; });
    const json again = rig.ok(c, "play", brief)["stroke"];
    CHECK(again.get<int>() > live.get<int>());
    CHECK(rig.find_end(c, again)["state"] == "finished");
    const auto told = c.box->streams();
    REQUIRE(told.size() >= 3);
    CHECK(told.back() == "running");
    CHECK(c.box->stroke_messages(played).size() == 1);
}

TEST_CASE("at the end each number has had exactly one end, whoever is still there")
{
    running_rig rig;
    const auto c = rig.client();
    std::vector<json> numbers;
    for (int i = 0; i < 10; ++i)
        numbers.push_back(rig.ok(c, "play", i % 2 == 0 ? armed : brief)["stroke"]);
    numbers.push_back(rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"]);
    for (int i = 0; i < 5; ++i)
        rig.send(c, rig.request(5000 + i, "play", brief));
    rig.close();
    for (int i = 0; i < 5; ++i) {
        REQUIRE(c.box->reply(5000 + i).has_value());
        const json r = *c.box->reply(5000 + i);
        if (r.contains("result"))
            numbers.push_back(r["result"]["stroke"]);
        else
            CHECK(r["error"]["code"] == -32000);
    }
    for (const json& n : numbers) {
        int ends = 0;
        for (const json& m : c.box->stroke_messages(n)) {
            ends += m["state"] != "started" ? 1 : 0;
            CHECK((m["state"] != "cancelled" || m["reason"] == "stopped by the owner"));
        }
        CHECK(ends == 1);
    }
    CHECK(c.box->streams() == std::vector<std::string>{"closing"});
    CHECK(rig.cards.back().closed());
}

TEST_CASE("an idle stream is closed, and opened by the next stroke")
{
    running_rig rig([](server::service_options&, server::stream_options& s) { s.times.idle_stop_s = 0.001; });
    const auto c = rig.client();
    rig.sleep_and_plug();
    CHECK(rig.ok(c, "fire") == json{{"count", 0}}); // nothing is armed, which is no error
    CHECK(rig.find_end(c, rig.ok(c, "drive", {{"tactor", 0}, {"duration_s", 0.1}})["stroke"])["state"] ==
          "finished");
}

TEST_CASE("a card that another program asks for is closed between strokes, and opened by the next one")
{
    std::shared_ptr<session::card_claim> card;
    running_rig rig([&card](server::service_options&, server::stream_options& s) { card = s.card; });
    const auto c = rig.client();
    const json number = rig.ok(c, "play", brief)["stroke"];
    CHECK_FALSE(card->idle);
    card->wanted = true; // a request that came just before the stroke waits for its end
    card->news();
    CHECK(rig.find_end(c, number)["state"] == "finished");
    rig.until([&] { return rig.cards.back().closed(); });
    CHECK_FALSE(card->wanted);
    const json now = rig.ok(c, "status")["stream"];
    CHECK(now["state"] == "idle");
    CHECK(now["reason"] == "another program asked for the card; the next stroke starts it");
    rig.sleep_and_plug();
    CHECK(rig.find_end(c, rig.ok(c, "play", brief)["stroke"])["state"] == "finished");
}

TEST_CASE("requests that want no stream do not keep it from being idle")
{
    running_rig rig([](server::service_options&, server::stream_options& s) { s.times.idle_stop_s = 0.02; });
    const auto c = rig.client();
    rig.until([&] {
        rig.ok(c, "plan", brief);
        rig.ok(c, "status");
        rig.all->disconnect(rig.client().number);
        return rig.all->output().state() == server::stream_state::idle;
    });
}

TEST_CASE("in a long buffer stop ends the stream, and the next stroke opens it again")
{
    service_rig rig;
    rig.buffer.period_frames = 4800;
    rig.buffer.periods = 5;
    rig.plug();
    rig.start();
    const auto c = rig.client();
    const auto other = rig.client();
    const json endless{{"path", "M 0 0 L 40 0"},
                       {"options", {{"algorithm", "tactile-brush"}, {"duration", 500}}}};
    const json numbers{rig.ok(c, "play", endless)["stroke"], rig.ok(c, "play", armed)["stroke"],
                       rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"]};
    CHECK(rig.ok(other, "stop").empty());
    CHECK(rig.ok(other, "status")["stream"]["state"] == "idle");
    rig.until([&] { return rig.cards.back().closed(); });
    for (const json& n : numbers) {
        CHECK(rig.find_end(c, n)["state"] == "cancelled");
        CHECK(rig.find_end(c, n)["reason"] == "stopped by another client");
    }
    rig.sleep_and_plug();
    CHECK(rig.find_end(c, rig.ok(c, "play", brief)["stroke"])["state"] == "finished");
    CHECK(rig.ok(c, "status")["stream"]["state"] == "running");
    for (const json& n : numbers)
        CHECK(c.box->stroke_messages(n).back() == rig.find_end(c, n));
}

TEST_CASE("a suspended device is no reason for the watchdog to end the service")
{
    service_rig rig;
    fake_dac& card = rig.plug();
    rig.start();
    card.suspend();
    rig.until([&] { return !rig.all->output().current()->position().running; });
    CHECK(rig.all->output().has_progressed());
    CHECK(rig.all->output().has_progressed());
}

TEST_CASE("a card that does not fit in the place of one that did is tried again")
{
    misfit card;
    running_rig rig([&](server::service_options&, server::stream_options& s) { card.replace(s); });
    rig.until([&] { return rig.all->output().state() == server::stream_state::running; });
    card.bad = true;
    rig.unplug();
    const int before = card.tries;
    rig.until([&] { return card.tries > before + 2; });
    CHECK(rig.all->output().state() == server::stream_state::lost);
    rig.plug();
    card.bad = false;
    rig.until([&] { return rig.all->output().state() == server::stream_state::running; });
    CHECK(card.refused == 0);
}

TEST_CASE("with an amplifier that may be on, a lost card is not opened again")
{
    std::atomic<int> opened{0};
    running_rig rig([&](server::service_options&, server::stream_options& s) {
        s.lines = session::lent_lines({.amplifier = std::make_unique<stuck_line>()});
        s.open = [&opened, open = s.open] {
            ++opened;
            return open();
        };
    });
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"stream"}}});
    rig.until([&] { return rig.all->output().amplifier() == session::amplifier_state::on; });
    rig.unplug();
    rig.plug();
    rig.until([&] { return rig.all->output().is_unavailable(); });
    CHECK(rig.all->output().reason().find("start the service again") != std::string::npos);
    CHECK(rig.all->output().amplifier() == session::amplifier_state::on);
    CHECK(rig.code(c, "play", brief) == -32000);
    CHECK(rig.code(c, "begin") == -32000);
    rig.io.poll();
    CHECK(opened == 1);
}

TEST_CASE("stop reaches what waits for an idle stream to start")
{
    std::promise<void> gate;
    std::atomic<int> opened{0};
    running_rig rig([&](server::service_options&, server::stream_options& s) {
        s.times.idle_stop_s = 0.001;
        s.open = [&, open = s.open, started = gate.get_future().share()] {
            if (opened++ == 1)
                started.wait();
            return open();
        };
    });
    const auto c = rig.client();
    rig.sleep_and_plug();
    const std::vector<std::pair<std::string, json>> asked{
        {"begin", json::object()}, {"play", brief}, {"play", armed}, {"drive", {{"tactor", 0}}}};
    for (std::size_t i = 0; i < asked.size(); ++i)
        rig.send(c, rig.request(1000 + static_cast<int>(i), asked[i].first, asked[i].second));
    rig.ok(c, "stop");
    gate.set_value();
    for (int id = 1000; id < 1004; ++id) {
        CAPTURE(asked[static_cast<std::size_t>(id - 1000)].first);
        const json n = rig.reply(c, id)["result"]["stroke"];
        const json end = rig.find_end(c, n);
        CHECK(end["state"] == "cancelled");
        CHECK(end["reason"] == "cancelled by its client");
        CHECK(end["frames"] == 0);
        CHECK(c.box->stroke_messages(n).size() == 1);
        CHECK(rig.code(c, "to", {{"stroke", n}, {"x_mm", 1}, {"y_mm", 1}}) == -32002);
    }
    // A request after the stop begins.
    rig.sleep_and_plug();
    CHECK(rig.find_end(c, rig.ok(c, "play", brief)["stroke"])["state"] == "finished");
    CHECK(rig.ok(c, "status")["strokes"].empty());
}

TEST_CASE("what is stopped before it is planned does not start an idle stream")
{
    std::atomic<int> opened{0};
    running_rig rig([&](server::service_options&, server::stream_options& s) {
        s.times.idle_stop_s = 0.001;
        s.open = [&opened, open = s.open] {
            ++opened;
            return open();
        };
    });
    const auto c = rig.client();
    rig.sleep_and_plug();
    // Both arrive before the context's thread hears of the plan.
    rig.send(c, rig.request(1000, "play", brief));
    rig.send(c, rig.request(1001, "stop"));
    const json end = rig.find_end(c, rig.reply(c, 1000)["result"]["stroke"]);
    CHECK(end["state"] == "cancelled");
    CHECK(end["reason"] == "cancelled by its client");
    CHECK(end["frames"] == 0);
    rig.io.poll();
    CHECK(rig.all->output().state() == server::stream_state::idle);
    CHECK(opened == 1);
}

} // namespace service_faults_test
