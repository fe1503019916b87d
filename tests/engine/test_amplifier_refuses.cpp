// SPDX-License-Identifier: MIT
// An amplifier whose line refuses to go off: the engine retries for a second, counts and reports it.
#include <algorithm>

#include <doctest/doctest.h>

#include "amplifier_rig.hpp"

namespace amplifier_refuses_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr const char* may_be_on = "the amplifier's line cannot be switched off: it may be on";
constexpr unsigned always = 1'000'000;

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

} // namespace

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
    const stroke_id next = r.submit(tone(0.1));
    r.play_out();
    CHECK(r.end(next).state == state_kind::finished);
}

TEST_CASE("a mute that stays refused ends the stream")
{
    playing r;
    r.line.refusals = always;
    r.dac.suspend();
    r.step();
    r.wait(500 * ms);
    CHECK_FALSE(r.link.amplifier.stuck);
    r.wait(600 * ms);
    CHECK(r.link.amplifier.stuck);
    r.dac.wake(true);
    end(r);
    CHECK(r.feed.end().why == may_be_on);
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

} // namespace amplifier_refuses_test
