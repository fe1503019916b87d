// SPDX-License-Identifier: MIT
// Commands that the control side puts into the ring, and its wake-ups.
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "engine/control/feeder.hpp"
#include "rig.hpp"
#include "scores.hpp"

namespace feeder_test {

using namespace tactor;
using namespace tactor::test;
using engine::command;

namespace {

std::vector<command> take_all(engine::link& l)
{
    std::vector<command> all;
    for (command c; l.commands.pop(c);)
        all.push_back(c);
    return all;
}

// Lists the commands in order: b a beginning, d a drive, e an end, each with the number of its stroke.
std::string in_order(engine::link& l)
{
    std::string all;
    std::map<engine::ticket, std::string> numbers;
    for (const command& c : take_all(l)) {
        if (c.what == command::kind::begin)
            numbers[c.score] = std::to_string(numbers.size() + 1);
        all += (c.what == command::kind::begin   ? "b"
                : c.what == command::kind::drive ? "d"
                                                 : "e") +
               numbers.at(c.score) + " ";
    }
    return all;
}

// Makes a score with a burst of 100 frames at each of these frames, each on another tactor.
score bursts_at(const std::vector<std::uint64_t>& frames)
{
    std::vector<burst> all;
    for (unsigned i = 0; i < frames.size(); ++i)
        all.push_back({.onset_s = static_cast<double>(frames[i]) / rate,
                       .duration_s = 100.0 / rate,
                       .drives = {{i, 0.5}}});
    return {palm(), make_bursts(std::move(all))};
}

// Plays a period; returns whether the control side was woken for it.
bool wakes(rig& r)
{
    r.dac.advance_queued(r.options.period);
    r.step();
    return r.link.to_control.consume() > 0;
}

// Plays until the stream has begun and its clock is known.
void settle(rig& r)
{
    for (int i = 0; i < 100; ++i)
        if (wakes(r))
            r.control();
}

} // namespace

TEST_CASE("a beginning and its first drives become visible together")
{
    // Otherwise a producer that loses its processor in between makes its stroke late.
    for (int round = 0; round < 300; ++round) {
        engine::link link;
        engine::feeder feed(link, 24'000);
        std::size_t seen = 0;
        std::thread audio([&] {
            while (seen == 0)
                seen = link.commands.size();
        });
        feed.submit({1}, tone(0.05), start_at::now());
        feed.pump(0);
        audio.join();
        REQUIRE(seen == 3);
    }
}

TEST_CASE("strokes that begin together get their first drives with their beginnings")
{
    engine::link link;
    engine::feeder feed(link, 24'000);
    for (std::uint32_t n = 1; n <= 3; ++n)
        feed.submit({n}, tone(0.05), start_at::now());
    feed.pump(0);
    CHECK(in_order(link) == "b1 d1 e1 b2 d2 e2 b3 d3 e3 ");
}

TEST_CASE(
    "a stroke that begins within an eighth of the horizon has its drives at once, others in the order of all")
{
    engine::link link;
    engine::feeder feed(link, 8000);
    std::uint32_t id = 0;
    for (const unsigned frame : {1500U, 1501U, 1501U})
        feed.submit({++id}, tone(0.05), start_at::frame(frame));
    feed.pump(500);
    CHECK(in_order(link) == "b1 d1 e1 b2 b3 d2 e2 d3 e3 ");
}

TEST_CASE("a beginning brings the drives of an eighth of the horizon")
{
    engine::link link;
    engine::feeder feed(link, 8000);
    feed.submit({1}, bursts_at({0, 1000, 1001}), start_at::now());
    feed.submit({2}, tone(0.05), start_at::now());
    feed.pump(0);
    CHECK(in_order(link) == "b1 d1 d1 b2 d2 e2 d1 e1 ");
}

TEST_CASE("strokes of a crowd that begin together each get a part of the first drives, none all of them")
{
    engine::link link(16'384);
    engine::feeder feed(link, 8000);
    const score s = bursts_at({0, 100, 200, 300, 400, 500, 600, 700, 800});
    for (std::uint32_t n = 1; n <= engine::voices; ++n)
        feed.submit({n}, s, start_at::now());
    feed.pump(0);
    const std::string all = in_order(link);
    CHECK(all.starts_with("b1 d1 d1 d1 d1 d1 d1 d1 d1 b2 d2 "));
    CHECK(all.find(" d511 b512 d512 d512 d512 d512 d512 d512 d512 d512 d1 ") != std::string::npos);
}

TEST_CASE("drives beyond the horizon wait, those within it are handed over at once")
{
    engine::link link;
    engine::feeder feed(link, 4800);
    const score s = random_score(1, 100);
    feed.submit({1}, s, start_at::now());
    feed.pump(0);
    std::vector<command> got = take_all(link);
    REQUIRE(got.size() > 1);
    CHECK(got.front().what == command::kind::begin);
    CHECK(got.front().length == s.frames());
    CHECK(got.back().drive.start <= 4800);
    feed.handle({.what = engine::report::kind::begun, .score = got.front().score, .frame = 10'000});
    feed.pump(10'000);
    CHECK(take_all(link).empty());
    std::uint64_t last = got.back().drive.start;
    for (std::uint64_t written = 10'096; written < 10'000 + s.frames(); written += 96) {
        feed.pump(written);
        for (const command& c : take_all(link)) {
            if (c.what == command::kind::end)
                continue;
            REQUIRE(c.what == command::kind::drive);
            CHECK(c.drive.start >= last);
            CHECK(c.drive.start + 10'000 <= written + 4800);
            CHECK(c.drive.start + 10'000 > written + 4800 - 96);
            last = c.drive.start;
        }
    }
}

TEST_CASE("drives of several strokes come in the order of their start")
{
    engine::link link;
    engine::feeder feed(link, 1'000'000);
    for (std::uint32_t n = 1; n <= 5; ++n)
        feed.submit({n}, random_score(n, 100), start_at::frame(1000 * n));
    feed.pump(0);
    std::map<engine::ticket, std::uint64_t> starts;
    std::uint64_t last = 0;
    std::size_t drives = 0;
    for (const command& c : take_all(link)) {
        if (c.what == command::kind::begin)
            starts[c.score] = c.at;
        if (c.what != command::kind::drive)
            continue;
        ++drives;
        // Drives that go with a beginning, an eighth of the horizon, are in the order of the strokes instead.
        if (c.drive.start <= 125'000)
            continue;
        CHECK(c.drive.start + starts[c.score] >= last);
        last = c.drive.start + starts[c.score];
    }
    CHECK(starts.size() == 5);
    CHECK(drives >= 5 * 100);
    CHECK(last > 0);
}

TEST_CASE("beginnings are urgent, drives are not")
{
    engine::link link;
    engine::feeder feed(link, 4800);
    feed.submit({1}, random_score(1, 100), start_at::now());
    feed.pump(0);
    CHECK(feed.take_wake_request());
    CHECK_FALSE(feed.take_wake_request());
    feed.handle({.what = engine::report::kind::begun, .score = take_all(link).front().score, .frame = 0});
    feed.pump(2400);
    CHECK(link.commands.size() > 0);
    CHECK_FALSE(feed.take_wake_request());
}

TEST_CASE("a full ring asks for a wake-up, and the feeder goes on where it was")
{
    engine::link link(4);
    engine::feeder feed(link, 1'000'000);
    feed.submit({1}, random_score(1, 30), start_at::now());
    feed.pump(0);
    CHECK(link.commands.size() == 4);
    CHECK(link.feeder_waits);
    std::size_t n = 0;
    std::size_t ends = 0;
    for (int i = 0; i < 100; ++i) {
        for (const command& c : take_all(link)) {
            ++n;
            ends += static_cast<std::size_t>(c.what == command::kind::end);
        }
        feed.pump(0);
    }
    CHECK(n >= 32);
    CHECK(ends == 1);
}

TEST_CASE("a stroke is handed over when it begins within the horizon, its last frame included")
{
    engine::link link;
    engine::feeder feed(link, 8000);
    feed.submit({1}, tone(0.05), start_at::frame(8500));
    feed.submit({2}, tone(0.05), start_at::frame(8501));
    feed.pump(500);
    CHECK(in_order(link) == "b1 d1 e1 ");
    feed.pump(501);
    CHECK(link.commands.size() == 3);
}

TEST_CASE("while a stroke waits for space to begin, playing strokes get only half of their horizon")
{
    engine::link link(8); // a beginning and its drives take up to 3
    engine::feeder feed(link, 8000);
    feed.submit({1}, bursts_at({0, 2000, 3000, 3500, 4000, 9000}), start_at::now());
    feed.pump(0);
    REQUIRE(link.commands.size() == 6);
    feed.handle({.what = engine::report::kind::begun, .score = link.commands.front()->score, .frame = 0});
    feed.submit({2}, tone(0.05), start_at::now());
    feed.pump(1100);
    CHECK(link.commands.size() == 6);
    CHECK(link.feeder_waits);
    take_all(link);
    feed.pump(1100);
    const std::vector<command> then = take_all(link);
    REQUIRE(then.size() == 5);
    CHECK(then[0].what == command::kind::begin);
    CHECK(then[3].what == command::kind::drive);
    CHECK(then[3].drive.start == 9000);
}

TEST_CASE("the lateness of a timed stroke is known even where the clock of its beginning is not")
{
    engine::clock_line clock{.epoch = 1, .time_ns = 1'000'000'000, .ns_per_frame = 1e9 / rate};
    engine::clock_line of_later = clock;
    of_later.first = 20'000;
    for (const engine::clock_line& then : {engine::clock_line{}, of_later}) {
        CAPTURE(then.valid());
        engine::link link;
        engine::feeder feed(link, 4800);
        feed.submit({1}, tone(0.01), start_at::time(rt::to_time(1'000'000'000)));
        feed.pump(9600, clock);
        const engine::ticket t = take_all(link).front().score;
        feed.pump(9600, then); // the device was started anew
        feed.handle({.what = engine::report::kind::begun, .score = t, .frame = 9600});
        feed.handle({.what = engine::report::kind::over,
                     .score = t,
                     .frame = 480,
                     .started = true,
                     .started_ns = 1'250'000'000});
        REQUIRE_FALSE(feed.reports().empty());
        CHECK(feed.reports().front().late_s == doctest::Approx(0.25));
    }
}

TEST_CASE("a cancelled stroke stays cancelled where the stream ends before its fade is reported")
{
    engine::link link;
    engine::feeder feed(link, 4800);
    for (std::uint32_t n = 1; n <= 2; ++n)
        feed.submit({n}, tone(1.0), start_at::now());
    feed.pump(0);
    CHECK(feed.cancel({1}));
    feed.handle({.what = engine::report::kind::stream_over, .why = reason_kind::lost});
    const auto& ends = feed.reports();
    REQUIRE(ends.size() == 2);
    CHECK(ending(ends.front()) == "cancelled");
    CHECK(ending(ends.back()) == "interrupted, lost: the device is gone");
}

TEST_CASE("the control side sleeps while there is no stroke, and feeds a new one at once")
{
    rig r;
    const score s = random_score(1, 100);
    REQUIRE(s.frames() > 10 * r.options.loop.horizon_frames);
    for (int strokes = 0; strokes < 3; ++strokes) {
        settle(r);
        for (int i = 0; i < 10'000; ++i) // half a minute and more
            REQUIRE_FALSE(wakes(r));
        const stroke_id id = r.submit(s);
        for (int i = 0; i < 10'000 && !r.report(id); ++i)
            if (wakes(r))
                r.control();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).frames == s.frames());
    }
}

TEST_CASE("a live stroke after a long unattended silence has all its time for a first point")
{
    live_options o{.timeout_s = 0.2};
    live_rig r(o);
    r.play(2 * 9600);
    REQUIRE(r.report(r.live->id)); // which had none
    settle(r);
    for (int i = 0; i < 1000; ++i)
        REQUIRE_FALSE(wakes(r));
    const auto next = r.add(o);
    r.play(9600 - 192);
    CHECK_FALSE(r.report(next->id));
    r.play(480);
    CHECK(r.end(next->id).reason == reason_kind::starved);
}

TEST_CASE("an xrun of a silent stream, its sleep and its waking up are reported at once")
{
    rig r;
    settle(r);
    CHECK_FALSE(wakes(r));
    r.dac.advance(1000); // runs dry
    CHECK(wakes(r));
    CHECK(r.link.count.xruns == 1);
    CHECK(wakes(r)); // the new epoch's clock is known
    CHECK_FALSE(wakes(r));
    r.dac.suspend();
    CHECK(wakes(r));
    CHECK_FALSE(wakes(r));
    r.dac.wake(true);
    CHECK(wakes(r));
    CHECK(r.status().running);
    CHECK(r.status().epoch == 3);
}

TEST_CASE("the fewest waiting drives are counted while a stroke is fed, not in silence and not at its end")
{
    rig r;
    r.play(9600);
    CHECK(r.link.count.low_water == UINT64_MAX);
    const stroke_id id = r.submit(random_score(1, 20));
    r.play_out();
    r.play(9600);
    REQUIRE(r.report(id));
    CHECK(r.link.count.low_water > 0);
    CHECK(r.link.count.low_water < 20);
}

} // namespace feeder_test
