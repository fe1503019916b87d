// SPDX-License-Identifier: MIT
// The amplifier's line through everything that can happen to the stream: the order of both, what the DAC
// received, what was reported.
#include <algorithm>

#include <doctest/doctest.h>

#include "amplifier_rig.hpp"

using namespace tactor;
using namespace tactor::test;

namespace {

const event_log opened{"prepare", "start"};

std::string reason_of(const amplifier_rig& r, stroke_id id)
{
    return r.report(id) ? r.report(id)->reason : "no report";
}

// An amplifier that is on, and a stroke that sounds.
struct playing : amplifier_rig {
    explicit playing(rig_options o = {}) : amplifier_rig(std::move(o))
    {
        REQUIRE(start().status == io_status::ok);
        warm_up();
        id = submit(tone(2.0));
        play(4800);
        CHECK(news() == event_log{"prepare", "start", "on"});
    }
    void xrun()
    {
        dac.advance(1000);
        step();
        control();
    }
    stroke_id id = 0;
};

} // namespace

TEST_CASE("a stroke that is submitted at once waits until the amplifier has settled, and is whole")
{
    amplifier_rig r;
    REQUIRE(r.start().status == io_status::ok);
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
    CHECK(r.report(id)->state == stroke_state::finished);
    const std::uint64_t first = *r.first_sound() - 1; // a sine begins with 0
    CHECK(r.captured(first, s.frames()) == rendered(s, sample_format::s32));
    CHECK(r.news() == event_log{"prepare", "start", "on"});
}

TEST_CASE("stop: fade, silence played, off, and only then drop")
{
    playing r;
    r.stop();
    bool heard = true;
    for (int i = 0; i < 100 && !r.loop.over(); ++i) {
        r.play(96);
        if (!r.line.is_on && heard) {
            // All that had sounded was out when it went off.
            CHECK(r.dac.queued() <= 288);
            heard = false;
            CHECK_FALSE(r.first_sound(r.dac.captured_frames() - r.dac.queued() - 96));
        }
    }
    r.control();
    CHECK(r.loop.over());
    CHECK(r.news() == event_log{"off", "drop"});
    CHECK(r.report(r.id)->state == stroke_state::cancelled);
}

TEST_CASE("an end that nobody answers comes all the same, after a quarter of a second of zeros")
{
    playing r;
    r.also_control = {};
    r.stop();
    const std::int64_t begun = r.now;
    for (int i = 0; i < 1000 && !r.loop.over(); ++i)
        r.play(96);
    CHECK(r.loop.over());
    CHECK(r.now - begun >= 250 * ms);
    CHECK(r.now - begun <= 320 * ms);
    CHECK(r.link.count.xruns == 0);
}

TEST_CASE("one xrun leaves the amplifier on; the stroke is interrupted, the next one sounds")
{
    playing r;
    const std::uint64_t cut = r.dac.captured_frames();
    r.xrun();
    CHECK(r.news() == event_log{"prepare", "start"});
    CHECK(reason_of(r, r.id) == "xrun: the device ran dry");
    r.play(9600);
    CHECK_FALSE(r.first_sound(cut));
    const score s = random_score(2, 3);
    const stroke_id next = r.submit(s);
    r.play_out();
    CHECK(r.report(next)->state == stroke_state::finished);
    CHECK(r.news().empty());
}

TEST_CASE("two xruns in a second mute; a stroke that comes meanwhile waits for the amplifier")
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
    CHECK(r.report(next)->state == stroke_state::finished);
    CHECK(r.captured(*r.first_sound(muted) - 1, s.frames()) == rendered(s, sample_format::s32));
}

TEST_CASE("xruns that end the stream: off before drop")
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

TEST_CASE("an unplugged device, one that fails to start again or stands still: off, then drop")
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
        CHECK(r.report(r.id)->state == stroke_state::interrupted);
    }
}

TEST_CASE("a system that sleeps: off; when it wakes up, the order of a start")
{
    playing r;
    r.dac.suspend();
    r.step();
    r.control();
    CHECK(r.news() == event_log{"off"});
    CHECK(reason_of(r, r.id) == "the system was suspended");
    r.wait(3000 * ms);
    r.dac.wake(true);
    for (int i = 0; i < 40; ++i)
        r.play(96);
    CHECK(r.news() == event_log{"prepare", "start", "on"});
    CHECK(r.link.amplifier.ready);
}

TEST_CASE("EINTR, no room and wake-ups in vain do not touch the line")
{
    playing r;
    for (int i = 0; i < 3; ++i)
        r.loop.step(io_status::again, r.now);
    r.dac.cry_ready(true);
    for (int i = 0; i < 20; ++i) {
        r.loop.step(io_status::ok, r.now);
        r.control();
    }
    r.dac.cry_ready(false);
    r.play(4800);
    CHECK(r.news().empty());
    CHECK(r.line.is_on);
}

TEST_CASE("an audio thread that stands still mutes within 150 ms, is counted, and comes back")
{
    playing r;
    const std::uint64_t sounding = r.status().written;
    r.wait(90 * ms);
    CHECK(r.line.is_on);
    r.wait(60 * ms);
    CHECK(r.news() == event_log{"off"});
    CHECK(r.link.count.stalls == 1);
    r.wait(1000 * ms);
    CHECK(r.link.count.stalls == 1);
    CHECK(r.news().empty());
    r.play(9600);
    CHECK(r.news() == event_log{"on"});
    CHECK(reason_of(r, r.id) == "the amplifier was off");
    // It fades, and nothing sounds any more.
    CHECK_FALSE(r.first_sound(sounding + 96 + 480 + 96));
    const stroke_id next = r.submit(tone(0.1));
    r.play_out();
    CHECK(r.report(next)->state == stroke_state::finished);
}

TEST_CASE("a stroke that waits for its frame while the amplifier is muted begins when that is on again")
{
    playing r;
    const score s = random_score(4, 2);
    const stroke_id later = r.submit(s, r.status().written + 3000);
    r.play(960);
    const std::uint64_t before = r.status().written;
    r.wait(200 * ms);
    r.play_out();
    CHECK(r.report(later)->state == stroke_state::finished);
    const auto sound = r.first_sound(before + 700);
    REQUIRE(sound);
    CHECK(r.captured(*sound - 1, s.frames()) == rendered(s, sample_format::s32));
}

TEST_CASE("the holder hears a beat every 50 ms, and a line that went off by itself is switched on again")
{
    playing r;
    const unsigned before = r.line.beats;
    r.play(48'000);
    CHECK(r.line.beats - before >= 20);
    r.line.is_on = false;
    r.play(9600);
    CHECK(r.line.is_on);
    CHECK(r.news() == event_log{"on"});
    CHECK(r.link.count.stalls == 1);
    CHECK(reason_of(r, r.id) == "the amplifier was off");
}

TEST_CASE("a line that cannot be switched ends the stream and says so")
{
    amplifier_rig r;
    r.line.works = false;
    REQUIRE(r.start().status == io_status::ok);
    const stroke_id id = r.submit(tone(0.1));
    r.play(9600);
    r.control();
    CHECK(r.loop.over());
    CHECK(r.report(id)->state == stroke_state::interrupted);
    CHECK(reason_of(r, id) == "the amplifier's line cannot be switched");
    CHECK(r.feed.stream_reason() == "the amplifier's line cannot be switched");
    CHECK_FALSE(r.first_sound());
    CHECK(r.news() == event_log{"prepare", "start", "on", "drop"});
}

TEST_CASE("a stroke that waits for the amplifier can be cancelled, and ends with the stream")
{
    for (const bool cancel : {false, true}) {
        amplifier_rig r;
        REQUIRE(r.start().status == io_status::ok);
        const stroke_id id = r.submit(tone(0.1));
        r.play(96);
        if (cancel)
            CHECK(r.feed.cancel(id));
        else
            r.stop();
        r.play(48'000);
        r.control();
        REQUIRE(r.report(id));
        CHECK(r.report(id)->state == stroke_state::cancelled);
        CHECK_FALSE(r.first_sound());
    }
}

TEST_CASE("whatever happens, nothing begins to sound while the amplifier is off or settles, and each stroke "
          "ends once")
{
    std::mt19937_64 random(99);
    for (int run = 0; run < 30; ++run) {
        rig_options o;
        o.loop.stall_ns = 100'000'000'000;
        amplifier_rig r(o);
        int dark = 0;
        REQUIRE(r.start().status == io_status::ok);
        for (int i = 0; i < 300 && !r.loop.over(); ++i) {
            if (random() % 4 == 0)
                r.submit(random_score(random(), 2));
            switch (random() % 40) {
            case 0:
                r.dac.advance(1000);
                break;
            case 1:
                r.dac.suspend();
                r.step();
                r.control();
                r.dac.wake(true);
                break;
            case 2:
                r.wait(200 * ms);
                break;
            case 3:
                r.line.is_on = false;
                break;
            default:
                break;
            }
            const std::uint64_t from = r.dac.captured_frames();
            r.play(96);
            // What sounded when it went off needs six periods to fade.
            dark = r.link.amplifier.ready ? 0 : dark + 1;
            if (dark > 7)
                CHECK_FALSE(r.first_sound(from));
        }
        r.stop();
        for (int i = 0; i < 1000 && !r.loop.over(); ++i)
            r.play(96);
        r.control();
        CHECK(r.loop.over());
        CHECK_FALSE(r.line.is_on);
        CHECK(r.ended.size() == r.last_id);
        for (const auto& [id, reports] : r.ended)
            CHECK(reports.size() == 1);
        CHECK(r.news().back() == "drop");
    }
}
