// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include "rounds.hpp"
#include "service_rig.hpp"

// Rounds of strokes that repeat, and strokes that join them to the frame.
namespace rounds_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr std::uint64_t rate = 48000;
constexpr std::uint64_t block = 2 * rate; // what is submitted of rounds of 0.1 s

// A touch that rests on one tactor of the preset (20 mm apart) for 0.1 s, so that it has a channel of its
// own.
json touch(double x_mm, double y_mm, const json& more = json::object())
{
    json params{{"points", {{0, x_mm, y_mm}, {0.1, x_mm, y_mm}}}, {"options", {{"algorithm", "continuous"}}}};
    params.update(more);
    return params;
}

struct sounds {
    std::uint64_t first = 0; ///< frames that are not silent
    std::uint64_t last = 0;
    std::uint64_t longest_gap = 0; ///< between two of them
};

sounds listen(const fake_dac& card, std::size_t channel)
{
    constexpr std::size_t frame = 9 * 4;
    const auto bytes = card.captured();
    std::optional<sounds> found;
    for (std::size_t i = 0; (i + 1) * frame <= bytes.size(); ++i) {
        std::int32_t v = 0;
        std::memcpy(&v, bytes.data() + i * frame + 4 * channel, sizeof v);
        if (v == 0)
            continue;
        if (!found)
            found = sounds{i, i, 0};
        found->longest_gap = std::max<std::uint64_t>(found->longest_gap, i - found->last);
        found->last = i;
    }
    REQUIRE(found);
    return *found;
}

// Under a sanitizer or emulation the clock may outrun a service this slow, so that its strokes end.
bool is_outrun(const char* name)
{
    if (shortened())
        std::printf("SKIPPED: %s: the clock outruns a service this slow\n", name);
    return shortened();
}

class kept_rig : public service_rig {
public:
    kept_rig() : card(make()) { start(); }

    json play(const connected& c, const json& params) { return ok(c, "play", params)["stroke"]; }
    // Waits until a stroke has begun and sounds for some seconds more.
    void let_sound(const connected& c, const json& n, std::uint64_t seconds)
    {
        until([&] { return !c.box->stroke_messages(n).empty(); });
        const std::uint64_t from = all->output().stats().frames;
        until([&] { return all->output().stats().frames > from + seconds * rate; });
    }
    // Cancels a stroke and returns what the card got of a channel.
    void cancel(const connected& c, const json& n)
    {
        ok(c, "cancel", {{"stroke", n}});
        CHECK(find_end(c, n)["state"] == "cancelled");
        clocks.clear();
    }

    fake_dac& card;

private:
    fake_dac& make()
    {
        captures = running_clock::capture_kind::kept;
        return plug();
    }
};

} // namespace

TEST_CASE("a stroke after one that repeats begins in the frame in which the next round would")
{
    if (is_outrun("a stroke after one that repeats"))
        return;
    kept_rig rig;
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"levels"}}});
    const json a = rig.play(c, touch(0, 0, {{"repeat", true}}));
    rig.let_sound(c, a, 3);
    const json b = rig.play(c, touch(40, 40, {{"repeat", true}, {"start", {{"after", a}}}}));
    const json end = rig.find_end(c, a);
    CHECK(end["state"] == "finished");
    const auto frames = end["frames"].get<std::uint64_t>();
    CHECK(frames % block == 0);
    CHECK(c.box->stroke_messages(a).size() == 2);
    rig.let_sound(c, b, 1);
    rig.cancel(c, b);
    const sounds before = listen(rig.card, 0);
    const sounds after = listen(rig.card, 8);
    CHECK(before.longest_gap <= 2); // the first frame of a round is silent
    CHECK(after.longest_gap <= 2);
    CHECK(after.first - before.first == frames);
    CHECK(after.first - before.last <= 2);
}

TEST_CASE(
    "a stroke after several that began together begins with the last of their rounds, and so does the next")
{
    if (is_outrun("a stroke after several"))
        return;
    kept_rig rig;
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"levels"}}});
    const json a = rig.play(c, touch(0, 0, {{"repeat", true}, {"start", "armed"}}));
    const json b = rig.play(c, touch(20, 0, {{"repeat", true}, {"start", "armed"}}));
    rig.ok(c, "fire");
    rig.let_sound(c, a, 3);
    const json after{{"after", {a, b}}};
    // Both are asked for at once: the clock may outrun a second request.
    rig.send(c, service_rig::request(101, "play", touch(0, 40, {{"start", after}})));
    rig.send(c, service_rig::request(102, "play", touch(20, 40, {{"start", after}})));
    const json d = rig.reply(c, 101)["result"]["stroke"];
    const json e = rig.reply(c, 102)["result"]["stroke"];
    for (const json& n : {a, b, d, e})
        CHECK(rig.find_end(c, n)["state"] == "finished");
    rig.clocks.clear();
    const std::uint64_t together = listen(rig.card, 6).first;
    CHECK(listen(rig.card, 7).first == together);
    const sounds first = listen(rig.card, 0);
    const sounds second = listen(rig.card, 1);
    CHECK((together - std::max(first.first, second.first)) % block == 0);
    CHECK(together - std::max(first.last, second.last) <= 2);
}

TEST_CASE("strokes of one file that repeat end with the same round")
{
    if (is_outrun("strokes of one file that repeat"))
        return;
    kept_rig rig;
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"levels"}}});
    const char* const two = "[[stroke]]\npath = 'M 0 0'\nduration_s = 0.1\n"
                            "[[stroke]]\npath = 'M 40 40'\nduration_s = 0.1\nstart_s = 0.5\n";
    const json params{{"toml", two}, {"options", {{"algorithm", "continuous"}}}, {"repeat", true}};
    const json numbers = rig.ok(c, "play", params)["strokes"];
    REQUIRE(numbers.size() == 2);
    rig.let_sound(c, numbers[1], 5);
    rig.ok(c, "end", {{"stroke", numbers[1]}});
    for (const json& n : numbers) {
        CHECK(rig.find_end(c, n)["state"] == "finished");
        CHECK(c.box->stroke_messages(n).size() == 2);
    }
    rig.clocks.clear();
    // Rounds last 0.6 s, and a submission has four: both strokes have as many.
    const sounds other = listen(rig.card, 8);
    constexpr std::uint64_t four_rounds = 4 * 6 * rate / 10;
    const sounds one = listen(rig.card, 0); // and half a second of silence before the next round
    CHECK((one.last - one.first + rate / 2 + 10) % four_rounds < 20);
    CHECK(other.last - one.last == other.first - one.first);
}

TEST_CASE("held strokes end with their client's connection, and others play on")
{
    running_rig rig;
    const auto watcher = rig.client();
    rig.ok(watcher, "subscribe", {{"events", {"strokes"}}});
    const auto goes = rig.client();
    constexpr double long_s = 500.0;
    const auto rests = [](double seconds, const json& more) {
        json params{{"points", {{0, 0, 0}, {seconds, 0, 0}}}, {"options", {{"algorithm", "continuous"}}}};
        params.update(more);
        return params;
    };
    const json held = rig.ok(goes, "play", rests(long_s, {{"held", true}}))["stroke"];
    const json repeats = rig.ok(goes, "play", touch(0, 0, {{"held", true}, {"repeat", true}}))["stroke"];
    const json plays_on = rig.ok(goes, "play", rests(1.0, {{"held", false}}))["stroke"];
    rig.until([&] { return !watcher.box->stroke_messages(held).empty(); });
    // Planned after the connection has ended: it must not begin.
    rig.send(goes, service_rig::request(101, "play", touch(0, 0, {{"held", true}})));
    rig.all->disconnect(goes.number);
    for (const json& n : {held, repeats}) {
        const json end = rig.find_end(watcher, n);
        CHECK(end["state"] == "cancelled");
        CHECK(end["reason"] == "its client's connection has ended");
    }
    CHECK(rig.find_end(watcher, plays_on)["state"] == "finished");
    const json late = rig.find_end(watcher, plays_on.get<unsigned>() + 1);
    CHECK(late["state"] == "cancelled");
    CHECK(late["frames"] == 0);
    CHECK(rig.code(watcher, "play", touch(0, 0, {{"held", 1}})) == -32602);
    CHECK(rig.code(watcher, "plan", touch(0, 0, {{"held", true}})) == -32602);
}

TEST_CASE("a round lasts as long as its client says, or as its strokes")
{
    running_rig rig;
    const auto c = rig.client();
    const auto frames = [&](double round_s) {
        const json n = rig.ok(c, "play", touch(0, 0, {{"repeat", 3}, {"round_s", round_s}}))["stroke"];
        return rig.find_end(c, n)["frames"];
    };
    CHECK(frames(0.25) == 2 * rate / 4 + rate / 10);
    CHECK(frames(0.05) == 3 * rate / 10);
    const json paused = touch(0, 0, {{"repeat", 3}, {"pause_s", 0.25}});
    CHECK(rig.find_end(c, rig.ok(c, "play", paused)["stroke"])["frames"] == 2 * rate / 4 + 3 * rate / 10);
    CHECK(rig.code(c, "play", touch(0, 0, {{"repeat", 3}, {"round_s", -1}})) == -32602);
    CHECK(rig.code(c, "play", touch(0, 0, {{"repeat", 3}, {"pause_s", -1}})) == -32602);
    CHECK(rig.code(c, "plan", touch(0, 0, {{"round_s", 1}})) == -32602);
}

TEST_CASE("after what does not sound nothing begins")
{
    running_rig rig;
    const auto c = rig.client();
    const auto other = rig.client();
    const auto code = [&](const json& after) {
        return rig.code(c, "play", touch(0, 0, {{"start", {{"after", after}}}}));
    };
    for (const json& wrong : {json(0), json(1.5), json("1"), json(nullptr), json::array(), json{1, "2"}})
        CHECK(code(wrong) == -32602);
    CHECK(code(1000) == -32002);
    const json armed = rig.ok(c, "play", touch(0, 0, {{"start", "armed"}}))["stroke"];
    CHECK(code(armed) == -32002);
    const json theirs = rig.ok(other, "play", touch(0, 0, {{"start", "armed"}}))["stroke"];
    CHECK(code(theirs) == -32002);
    const json live =
        rig.ok(c, "begin", {{"timeout_s", 86400}})["stroke"]; // its clock outruns a slow service
    CHECK(code(live) == -32002);
    const json once = rig.ok(c, "play", touch(0, 0, {{"start", "armed"}}))["stroke"];
    CHECK(rig.code(c, "end", {{"stroke", once}}) == -32002);
    CHECK(rig.ok(c, "status")["strokes"].size() == 4); // none of the refused ones
}

TEST_CASE("what joins a round is stopped with everything, and ends once")
{
    if (is_outrun("what joins a round is stopped"))
        return;
    running_rig rig;
    const auto c = rig.client();
    rig.ok(c, "subscribe", {{"events", {"levels"}}});
    const json a = rig.ok(c, "play", touch(0, 0, {{"repeat", true}}))["stroke"];
    rig.until([&] { return !c.box->stroke_messages(a).empty(); });
    const json b = rig.ok(c, "play", touch(40, 40, {{"repeat", true}, {"start", {{"after", a}}}}))["stroke"];
    rig.ok(c, "stop");
    for (const json& n : {a, b}) {
        const json end = rig.find_end(c, n);
        CHECK(end["state"] == "cancelled");
        CHECK(end["reason"] == "cancelled by its client");
    }
    rig.ok(c, "status");
    CHECK(c.box->stroke_messages(a).size() == 2);
    CHECK(c.box->find_end(b));
}

} // namespace rounds_test
