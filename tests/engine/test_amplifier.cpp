// SPDX-License-Identifier: MIT
// The amplifier's line through every event of the stream, and through its own failures.
#include <algorithm>
#include <cerrno>
#include <random>

#include <doctest/doctest.h>

#include "amplifier_rig.hpp"

namespace amplifier_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// Plays until the stream is over; returns how long that took, ns.
std::int64_t end(amplifier_rig& r)
{
    const std::int64_t begun = r.now;
    for (int i = 0; i < 4000 && !r.loop.over(); ++i)
        r.play(96);
    r.control();
    REQUIRE(r.loop.over());
    return r.now - begun;
}

std::ptrdiff_t offs(const event_log& log)
{
    return std::count(log.begin(), log.end(), "off");
}

constexpr const char* may_be_on = "the amplifier's line cannot be switched off: it may be on";
constexpr unsigned always = 1'000'000;

} // namespace

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
    const std::uint64_t before = r.dac.captured_frames();
    const std::int64_t took = end(r);
    CHECK(r.dac.captured_frames() - before >= 90'000);
    CHECK(took >= 2000 * ms);
    CHECK(took <= 2070 * ms);
    CHECK(r.feed.end().why == may_be_on);
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
    CHECK(r.play_out(next).state == state_kind::finished);
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

TEST_CASE("a device that stands still, is unplugged, fails to start again or always runs dry: off, then drop")
{
    for (const int how : {0, 1, 2, 3, 4}) {
        CAPTURE(how);
        playing r;
        if (how == 1)
            r.dac.disconnect();
        if (how == 2)
            r.dac.fail_prepare(-EIO);
        if (how == 3)
            r.dac.fail_start(-EIO);
        for (int i = 0; how == 4 && i < 3; ++i) {
            r.xrun();
            r.play(960);
        }
        if (how > 1)
            r.dac.advance(1000);
        r.run_until_over(1000);
        r.control();
        CHECK(r.loop.over());
        CHECK_FALSE(r.line.is_on);
        const event_log log = r.news();
        REQUIRE(log.size() >= 2);
        CHECK(log.back() == "drop");
        CHECK(offs(log) == 1);
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
    r.play(3840);
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
        CHECK(offs(r.news()) == 1);
        CHECK_FALSE(r.line.is_on);
        r.play(3840);
        CHECK(r.news() == event_log{"on"});
    }
}

TEST_CASE("a line that must be off is off within 50 ms, stays off through a sleep, and then goes on")
{
    for (const bool sleeps : {false, true}) {
        playing r;
        r.line.withheld = true;
        r.wait(50 * ms);
        CHECK(r.news() == event_log{"off"});
        r.play(48'000);
        CHECK(r.end(r.id).why == "the amplifier was off");
        const score s = random_score(2, 3);
        const stroke_id next = r.submit(s);
        if (sleeps) {
            r.dac.suspend();
            r.step();
            r.control();
            r.dac.wake(false);
        }
        r.play(48'000);
        CHECK(r.news() == (sleeps ? event_log{"prepare", "start"} : event_log{}));
        CHECK_FALSE(r.link.amplifier.ready);
        r.line.withheld = false;
        const std::uint64_t silent = r.dac.captured_frames();
        r.play_out();
        CHECK(r.news() == event_log{"on"});
        if (!sleeps) {
            CHECK(r.end(next).state == state_kind::finished);
            CHECK(r.captured(*r.first_sound(silent) - 1, s.frames()) == rendered(s, format_kind::s32));
        }
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
    CHECK(r.play_out(r.submit(tone(0.1))).state == state_kind::finished);
}

TEST_CASE("a stroke that waits for its frame during a mute begins when the amplifier is on again")
{
    playing r;
    const score s = random_score(4, 2);
    const stroke_id later = r.submit(s, r.status().written + 3000);
    r.play(960);
    const std::uint64_t before = r.status().written;
    r.wait(200 * ms);
    CHECK(r.play_out(later).state == state_kind::finished);
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
        end(r);
        CHECK_FALSE(r.line.is_on);
        CHECK(r.ended.size() == r.last_id);
        for (const auto& [id, reports] : r.ended)
            CHECK(reports.size() == 1);
        CHECK(r.news().back() == "drop");
    }
}

TEST_CASE("at the last stop, an off that is refused is tried again before the DAC stops")
{
    playing r;
    r.line.refusals = 3;
    r.stop();
    CHECK(end(r) < 100 * ms);
    CHECK_FALSE(r.line.is_on);
    CHECK(r.news() == event_log{"off", "off", "off", "off", "drop"});
    CHECK(r.link.count.off_failures == 3);
    CHECK_FALSE(r.link.amplifier.stuck);
    CHECK(r.feed.end().why.empty());
}

TEST_CASE("a line that never goes off is tried for a second, and the stream's reason says so")
{
    playing r;
    r.line.refusals = always;
    r.stop();
    const std::int64_t took = end(r);
    CHECK(took >= 1000 * ms);
    CHECK(took < 1100 * ms);
    const event_log log = r.news();
    CHECK(log.back() == "drop");
    CHECK(offs(log) >= 50);
    CHECK(offs(log) <= 102);
    CHECK(r.link.count.off_failures == static_cast<std::uint64_t>(offs(log)));
    CHECK(r.link.amplifier.stuck);
    CHECK_FALSE(r.link.amplifier.off);
    CHECK(r.feed.end().why == may_be_on);
    CHECK(r.end(r.id).state == state_kind::cancelled);

    r.driver.close(); // a last try, refused too
    CHECK(offs(r.news()) == 1);
    CHECK_FALSE(r.link.amplifier.off);
    r.line.refusals = 0;
    r.driver.close();
    CHECK_FALSE(r.line.is_on);
    CHECK(r.link.amplifier.off);
}

TEST_CASE("a mute that is refused once is retried, and the stream goes on")
{
    playing r;
    r.line.refusals = 2;
    r.wait(140 * ms); // the audio thread stands still
    CHECK_FALSE(r.line.is_on);
    CHECK(r.link.count.off_failures == 2);
    CHECK(offs(r.news()) == 3);
    r.play(9600);
    CHECK(r.news() == event_log{"on"});
    CHECK(r.end(r.id).why == "the amplifier was off");
    CHECK(r.play_out(r.submit(tone(0.1))).state == state_kind::finished);
}

TEST_CASE("a mute that stays refused ends the stream, also while the system sleeps")
{
    for (const bool wakes : {true, false}) {
        CAPTURE(wakes);
        playing r;
        r.line.refusals = always;
        r.dac.suspend();
        r.step();
        r.wait(500 * ms);
        CHECK_FALSE(r.link.amplifier.stuck);
        r.wait(600 * ms);
        CHECK(r.link.amplifier.stuck);
        if (wakes)
            r.dac.wake(true);
        end(r);
        CHECK(r.feed.end().why == may_be_on);
    }
}

TEST_CASE("a device lost while the line refuses: the reason names the line that may be on")
{
    playing r;
    r.line.refusals = always;
    r.dac.disconnect();
    for (int i = 0; i < 400 && !r.loop.over(); ++i) {
        r.now += 10 * ms;
        r.step();
        r.control();
    }
    r.control();
    CHECK(r.loop.over());
    CHECK(r.end(r.id).why == "the device is gone");
    CHECK(r.feed.end().why == may_be_on);
}

TEST_CASE("a line that refuses to go on is switched off, since it may have gone on, and ends the stream")
{
    for (const unsigned refusals : {0U, 1U}) {
        CAPTURE(refusals);
        amplifier_rig r;
        r.line.works = false;
        r.line.refusals = refusals;
        const stroke_id id = r.submit(tone(0.1));
        r.play(9600);
        r.control();
        CHECK(r.loop.over());
        event_log expected{"prepare", "start", "on", "off", "drop"};
        expected.insert(expected.end() - 1, refusals, "off");
        CHECK(r.news() == expected);
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the amplifier's line cannot be switched");
        CHECK(r.feed.end().why == "the amplifier's line cannot be switched");
        CHECK_FALSE(r.first_sound());
    }
}

TEST_CASE("a line that refuses to go on is switched off at once, and mutes nothing")
{
    amplifier_rig r;
    r.line.works = false;
    for (event_log seen; seen.empty() || seen.back() == "start"; seen = r.news())
        r.play(r.options.period);
    CHECK_FALSE(r.line.is_on);
    CHECK(r.link.amplifier.off); // in the update in which it refused
    CHECK(r.link.amplifier.mutes == 0);
}

TEST_CASE("the line stays off when the audio thread decides to end between two looks of the amplifier's")
{
    for (const int ends_at : {2, 3, 4}) {
        CAPTURE(ends_at);
        event_log log;
        logging_line line(log);
        engine::link link;
        link.amplifier.status.store(
            {.running = true, .stage = engine::stream_stage::running, .epoch = 1, .epoch_played = 1000});
        int looks = 0;
        bool stops = false; // what audio_loop::finish() does: it stops the DAC where the line is off
        engine::amplifier_driver driver(link, line, {.amplifier = {.proof_frames = 1}}, [&] {
            if (++looks == ends_at) {
                link.amplifier.ending.store(true, std::memory_order_seq_cst);
                stops = link.amplifier.off.load(std::memory_order_seq_cst);
            }
            return looks * ms;
        });
        driver.update();
        CHECK((stops ? log.empty() : log == event_log{"on"}));
        CHECK(stops == (ends_at < 4)); // the fourth look is after the line went on
    }
}

TEST_CASE("the amplifier does not go on again before the audio thread has seen the mute")
{
    amplifier_rig r;
    r.warm_up();
    r.play(4800);
    engine::stream_status before = r.status();
    r.news();
    r.line.is_on = false; // the next beat shows it
    r.wait(60 * ms);
    CHECK(r.news() == event_log{"off"});
    // Stands for a wake-up that began before the mute and took long.
    before.epoch_played += 10 * std::uint64_t{r.options.period};
    r.link.amplifier.status.store(before);
    r.driver.update();
    CHECK(r.news().empty());
    r.play(4800);
    CHECK(r.news() == event_log{"on"});
}

TEST_CASE("time in which the amplifier's thread did not run is no stall of the audio thread")
{
    playing r;
    r.now += 10'000 * ms; // SIGSTOP, or a debugger
    r.driver.update();
    CHECK(r.news().empty());
    CHECK(r.link.count.stalls == 0);
    r.play(4800);
    CHECK(r.news().empty());
}

TEST_CASE("a lost line counts as on until it is switched off")
{
    playing r;
    r.line.is_on = false; // beat() returns this
    r.line.refusals = always;
    r.play(4800);
    CHECK_FALSE(r.link.amplifier.off);
    r.stop();
    end(r);
    CHECK(r.feed.end().why == may_be_on);
}

} // namespace amplifier_test
