// SPDX-License-Identifier: MIT
// The amplifier when something other than the stream fails: a stalled thread, a failing line, a holder that
// switched off; and all of it at random.
#include <random>

#include <doctest/doctest.h>

#include "amplifier_rig.hpp"

namespace amplifier_watch_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("an audio thread that stands still mutes within 150 ms, is counted, and recovers")
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
    CHECK(r.end(r.id).why == "the amplifier was off");
    // It fades, then nothing sounds.
    CHECK_FALSE(r.first_sound(sounding + 96 + 480 + 96));
    const stroke_id next = r.submit(tone(0.1));
    r.play_out();
    CHECK(r.end(next).state == state_kind::finished);
}

TEST_CASE("a stroke that waits for its frame during a mute begins when the amplifier is on again")
{
    playing r;
    const score s = random_score(4, 2);
    const stroke_id later = r.submit(s, r.status().written + 3000);
    r.play(960);
    const std::uint64_t before = r.status().written;
    r.wait(200 * ms);
    r.play_out();
    CHECK(r.end(later).state == state_kind::finished);
    const auto sound = r.first_sound(before + 700);
    REQUIRE(sound);
    CHECK(r.captured(*sound - 1, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("the holder gets a beat every 50 ms, and a line that went off by itself is switched on again")
{
    playing r;
    const unsigned before = r.line.beats;
    r.play(48'000);
    CHECK(r.line.beats - before >= 20);
    r.line.is_on = false;
    r.play(9600);
    CHECK(r.line.is_on);
    CHECK(r.news() == event_log{"off", "on"}); // only switching tells whether it is off
    CHECK(r.link.count.stalls == 1);
    CHECK(r.end(r.id).why == "the amplifier was off");
}

TEST_CASE("frames written before a mute are over when the amplifier goes on again, for any buffer length")
{
    for (const unsigned periods : {3U, 50U, 250U})
        for (const bool stalls : {false, true}) {
            CAPTURE(periods);
            CAPTURE(stalls);
            playing r({.periods = periods});
            if (stalls)
                r.wait(200 * ms);
            else
                r.line.is_on = false;
            for (int i = 0; i < 1000 && r.link.amplifier.ready; ++i)
                r.play(96);
            const stroke_id next = r.submit(tone(0.1));
            for (int i = 0; i < 1000 && !r.line.is_on; ++i)
                r.play(96);
            CHECK(r.line.is_on);
            const std::uint64_t on = r.dac.captured_frames() - r.dac.queued();
            r.play_out();
            CHECK(r.end(r.id).why == "the amplifier was off");
            CHECK(r.end(next).state == state_kind::finished);
            // Only the next stroke sounds, behind 10 ms of silence and the buffer.
            const auto sound = r.first_sound(on);
            REQUIRE(sound);
            CHECK(*sound >= on + 480 + std::uint64_t{periods - 1} * 96);
        }
}

TEST_CASE("the amplifier's real-time thread sleeps while it waits for the DAC after a mute that is long over")
{
    playing r;
    r.xrun();
    r.play(9600);
    r.xrun();
    r.play(96'000);
    REQUIRE(r.line.is_on);
    r.line.is_on = false;
    for (int i = 0; i < 6; ++i) { // the next beat shows it
        r.now += 10 * ms;
        r.driver.update();
    }
    CHECK(r.news().back() == "off");
    CHECK(r.driver.next_ns() > 0);
    r.play(9600);
    CHECK(r.line.is_on);
}

TEST_CASE("a stroke that waits for the amplifier can be cancelled, and ends with the stream")
{
    for (const bool cancel : {false, true}) {
        amplifier_rig r;
        const stroke_id id = r.submit(tone(0.1));
        r.play(96);
        if (cancel)
            CHECK(r.feed.cancel(id));
        else
            r.stop();
        r.play(48'000);
        r.control();
        CHECK(r.end(id).state == state_kind::cancelled);
        CHECK_FALSE(r.first_sound());
    }
}

TEST_CASE(
    "random faults: nothing begins to sound while the amplifier is off or settles, and each stroke ends once")
{
    std::mt19937_64 random(99);
    for (int run = 0; run < 30; ++run) {
        rig_options o;
        o.loop.stall_ns = 100'000'000'000;
        amplifier_rig r(o);
        int dark = 0;
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
            // Sound from before the mute needs six periods to fade.
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

} // namespace amplifier_watch_test
