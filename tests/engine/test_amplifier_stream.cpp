// SPDX-License-Identifier: MIT
// The amplifier's line through every event of the stream: their order, the bytes at the DAC, the reports.
#include <algorithm>

#include <cerrno>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

#include "amplifier_rig.hpp"

namespace amplifier_stream_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("a stroke submitted at once waits until the amplifier has settled, and is whole")
{
    amplifier_rig r;
    const score s = random_score(3, 4);
    const stroke_id id = r.submit(s);
    std::uint64_t on_at = 0;
    while (!r.line.is_on) {
        r.play(96);
        on_at = r.status().played;
        REQUIRE(on_at < 10'000);
    }
    CHECK(on_at >= 192);
    r.play_out();
    REQUIRE(r.first_sound());
    CHECK(*r.first_sound() >= on_at + 480);
    CHECK(*r.first_sound() <= on_at + 480 + 4 * 96 + 960);
    CHECK(r.end(id).state == state_kind::finished);
    const std::uint64_t first = *r.first_sound() - 1; // a sine begins with 0
    CHECK(r.captured(first, s.frames()) == rendered(s, format_kind::s32));
    CHECK(r.news() == event_log{"prepare", "start", "on"});
}

TEST_CASE("stop fades, plays silence, switches off, and only then drops")
{
    playing r;
    r.stop();
    bool heard = true;
    for (int i = 0; i < 100 && !r.loop.over(); ++i) {
        r.play(96);
        if (!r.line.is_on && heard) {
            // The last sound was out when it went off.
            CHECK(r.dac.queued() <= 288);
            heard = false;
            CHECK_FALSE(r.first_sound(r.dac.captured_frames() - r.dac.queued() - 96));
        }
    }
    r.control();
    CHECK(r.loop.over());
    CHECK(r.news() == event_log{"off", "drop"});
    CHECK(r.end(r.id).state == state_kind::cancelled);
}

TEST_CASE("a stop that gets no answer ends after two seconds of zeros, with the reason")
{
    playing r;
    r.also_control = {};
    r.stop();
    const std::int64_t begun = r.now;
    for (int i = 0; i < 2000 && !r.loop.over(); ++i)
        r.play(96);
    CHECK(r.loop.over());
    CHECK(r.now - begun >= 2000 * ms);
    CHECK(r.now - begun <= 2070 * ms);
    r.control();
    CHECK(r.feed.end().why == "the amplifier's line cannot be switched off: it may be on");
    CHECK(r.link.count.xruns == 0);
}

TEST_CASE("one xrun leaves the amplifier on; the stroke is interrupted, the next one sounds")
{
    playing r;
    const std::uint64_t cut = r.dac.captured_frames();
    r.xrun();
    CHECK(r.news() == event_log{"prepare", "start"});
    CHECK(r.end(r.id).why == "xrun: the device ran dry");
    r.play(9600);
    CHECK_FALSE(r.first_sound(cut));
    const score s = random_score(2, 3);
    const stroke_id next = r.submit(s);
    r.play_out();
    CHECK(r.end(next).state == state_kind::finished);
    CHECK(r.news().empty());
}

TEST_CASE("two xruns in a second mute; a new stroke waits for the amplifier")
{
    playing r;
    r.xrun();
    r.play(9600);
    r.xrun();
    CHECK(r.news() == event_log{"prepare", "start", "prepare", "start", "off"});
    const std::uint64_t muted = r.dac.captured_frames();
    const score s = random_score(2, 3);
    const stroke_id next = r.submit(s);
    r.play(40'000);
    CHECK_FALSE(r.first_sound(muted));
    CHECK_FALSE(r.line.is_on);
    r.play_out();
    CHECK(r.news() == event_log{"on"});
    CHECK(r.end(next).state == state_kind::finished);
    CHECK(r.captured(*r.first_sound(muted) - 1, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("xruns that end the stream switch off before the drop")
{
    playing r;
    for (int i = 0; i < 4; ++i) {
        r.xrun();
        r.play(960);
    }
    r.control();
    CHECK(r.loop.over());
    CHECK_FALSE(r.line.is_on);
    const event_log log = r.news();
    REQUIRE(log.size() > 2);
    CHECK(log.back() == "drop");
    CHECK(std::count(log.begin(), log.end(), "off") == 1);
    CHECK(std::count(log.begin(), log.end(), "on") == 0);
}

TEST_CASE("a device that is unplugged, fails to start again or stands still: off, then drop")
{
    for (const int how : {0, 1, 2, 3}) {
        CAPTURE(how);
        playing r;
        if (how == 0)
            r.dac.disconnect();
        if (how == 1)
            r.dac.fail_prepare(-EIO);
        if (how == 2)
            r.dac.fail_start(-EIO);
        if (how == 1 || how == 2)
            r.dac.advance(1000);
        for (int i = 0; i < 1000 && !r.loop.over(); ++i) {
            r.step();
            r.control();
        }
        r.control();
        CHECK(r.loop.over());
        CHECK_FALSE(r.line.is_on);
        const event_log log = r.news();
        REQUIRE(log.size() >= 2);
        CHECK(log.back() == "drop");
        CHECK(std::count(log.begin(), log.end(), "off") == 1);
        CHECK(r.end(r.id).state == state_kind::interrupted);
    }
}

TEST_CASE("a system that sleeps switches off; waking up follows the order of a start")
{
    playing r;
    r.dac.suspend();
    r.step();
    r.control();
    CHECK(r.news() == event_log{"off"});
    CHECK(r.end(r.id).why == "the system was suspended");
    r.wait(3000 * ms);
    r.dac.wake(true);
    for (int i = 0; i < 40; ++i)
        r.play(96);
    CHECK(r.news() == event_log{"prepare", "start", "on"});
    CHECK(r.link.amplifier.ready);
}

TEST_CASE("the amplifier's thread notices a sleep that begins and ends between two of its updates")
{
    for (const bool can_resume : {true, false}) {
        playing r;
        r.dac.suspend();
        r.step();
        r.dac.wake(can_resume);
        r.step();
        REQUIRE(r.status().running);
        r.control();
        const event_log seen = r.news();
        CHECK(std::count(seen.begin(), seen.end(), "off") == 1);
        CHECK_FALSE(r.line.is_on);
        for (int i = 0; i < 40; ++i)
            r.play(96);
        CHECK(r.news() == event_log{"on"});
    }
}

TEST_CASE("EINTR, no space and idle wake-ups do not touch the line")
{
    playing r;
    for (int i = 0; i < 3; ++i)
        r.loop.step(io_kind::again, r.now);
    r.dac.cry_ready(true);
    for (int i = 0; i < 20; ++i) {
        r.loop.step(io_kind::ok, r.now);
        r.control();
    }
    r.dac.cry_ready(false);
    r.play(4800);
    CHECK(r.news().empty());
    CHECK(r.line.is_on);
}

TEST_CASE("short writes, writes of nothing and EAGAIN leave the samples and the line as they are")
{
    amplifier_rig r;
    r.warm_up();
    const score s = random_score(8, 5);
    const std::uint64_t from = r.dac.captured_frames();
    const stroke_id id = r.submit(s);
    std::mt19937_64 random(5);
    while (!r.report(id)) {
        if (random() % 3 == 0)
            r.spoilt->push_back({io_kind::ok, random() % 96, 0});
        if (random() % 9 == 0)
            r.spoilt->push_back({io_kind::again, 0, -EAGAIN});
        r.play(96);
        REQUIRE(r.dac.captured_frames() < from + s.frames() + 48'000);
    }
    CHECK(r.end(id).state == state_kind::finished);
    const auto first = r.first_sound(from);
    REQUIRE(first);
    CHECK(r.captured(*first - 1, s.frames()) == rendered(s, format_kind::s32));
    CHECK(r.news() == event_log{"prepare", "start", "on"});
}

TEST_CASE("a write that fails for good switches off, then drops, and reports the reason")
{
    for (const auto& [status, code, why] :
         {std::tuple{io_kind::failed, -EIO, "the device failed: Input/output error"},
          std::tuple{io_kind::failed, -EBADFD, "the device failed: File descriptor in bad state"},
          std::tuple{io_kind::lost, -ENODEV, "the device is gone"}}) {
        playing r;
        r.spoilt->push_back({status, 0, code});
        r.play(960);
        r.control();
        CHECK(r.loop.over());
        CHECK(r.news() == event_log{"off", "drop"});
        CHECK(r.end(r.id).why == why);
    }
}

} // namespace amplifier_stream_test
