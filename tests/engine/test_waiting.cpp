// SPDX-License-Identifier: MIT
// Strokes that wait, for the amplifier, for a point, for others: cancel and stop reach them at once.

#include <doctest/doctest.h>

#include "live_rig.hpp"

namespace waiting_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// Returns options without an amplifier driver: strokes wait until the test sets it ready.
rig_options held()
{
    rig_options o;
    o.loop.amplifier = true;
    return o;
}

live_options with_timeout(double s)
{
    live_options o;
    o.timeout_s = s;
    return o;
}

state_kind unheard_state(const rig& r, stroke_id id)
{
    CHECK(r.end(id).frames == 0);
    return r.end(id).state;
}

} // namespace

TEST_CASE("while the amplifier settles a cancel is reported with the next wake-up, and other strokes play")
{
    rig r(held());
    const score kept = random_score(3, 5);
    const stroke_id first = r.submit(tone(1.0));
    const stroke_id second = r.submit(kept);
    const stroke_id third = r.submit(tone(1.0));
    r.play(960);
    CHECK(r.ended.empty());
    CHECK(r.feed.cancel(first));
    CHECK(r.feed.cancel(third));
    CHECK_FALSE(r.feed.cancel(first));
    r.step(); // the DAC stands still
    r.control();
    CHECK(unheard_state(r, first) == state_kind::cancelled);
    CHECK(unheard_state(r, third) == state_kind::cancelled);
    CHECK_FALSE(r.report(second));

    const std::uint64_t from = r.status().written;
    r.link.amplifier.ready = true;
    r.play_out();
    CHECK(r.end(second).state == state_kind::finished);
    CHECK(r.captured(from, kept.frames()) == rendered(kept, format_kind::s32));
    CHECK(r.ended.size() == 3);
}

TEST_CASE("thousands of strokes submitted and cancelled while they wait end once each, unheard")
{
    rig r(held());
    constexpr unsigned rounds = 2000;
    for (unsigned n = 1; n <= rounds; ++n) {
        r.submit(tone(0.01, n % 9));
        if (n % 7 == 0)
            r.play(96);
        CHECK(r.feed.cancel({n}));
        if (n % 5 == 0)
            r.play(96);
    }
    r.play(960);
    CHECK(r.ended.size() == rounds);
    for (unsigned n = 1; n <= rounds; ++n)
        CHECK(unheard_state(r, {n}) == state_kind::cancelled);
    r.link.amplifier.ready = true;
    r.play(9600);
    CHECK_FALSE(r.first_sound());
    CHECK(r.ended.size() == rounds);
    const stroke_id next = r.submit(tone(0.01));
    r.play_out();
    CHECK(r.end(next).state == state_kind::finished);
    CHECK(r.first_sound());
}

TEST_CASE("stop reaches strokes that wait for the amplifier")
{
    rig r(held());
    const stroke_id cancelled = r.submit(tone(1.0));
    const stroke_id stopped = r.submit(tone(1.0));
    CHECK(r.feed.cancel(cancelled));
    r.stop();
    r.step();
    r.control();
    CHECK(unheard_state(r, cancelled) == state_kind::cancelled);
    CHECK(unheard_state(r, stopped) == state_kind::cancelled);
    r.play(4 * 96 + 288);
    CHECK(r.loop.over());
}

TEST_CASE("live strokes behind a waiting stroke end, cancel and time out as without it")
{
    rig_options o = held();
    live_rig r(with_timeout(0.2), o);
    const stroke_id before = r.submit(tone(0.1));
    const auto ended = r.add(with_timeout(0.2));
    const auto cancelled = r.add(with_timeout(0.2));
    const auto fed = r.add(with_timeout(0.2));
    r.play(960);
    ended->voice.request(engine::live_voice::action::end);
    cancelled->voice.request(engine::live_voice::action::cancel);
    r.play(192);
    CHECK(unheard_state(r, ended->id) == state_kind::finished);
    CHECK(unheard_state(r, cancelled->id) == state_kind::cancelled);
    for (int i = 0; i < 110; ++i) {
        fed->to({0.0, 0.0}, 1.0);
        r.play(96);
    }
    CHECK(unheard_state(r, r.live->id) == state_kind::interrupted);
    CHECK(r.end(r.live->id).why == "no more points came");
    CHECK(r.end(r.live->id).reason == reason_kind::starved);
    CHECK_FALSE(r.report(before));
    CHECK_FALSE(r.report(fed->id));
    CHECK_FALSE(r.first_sound());
    r.link.amplifier.ready = true;
    r.play(960);
    CHECK(r.first_sound());
    fed->voice.request(engine::live_voice::action::end);
    r.play_out();
    CHECK(r.end(fed->id).state == state_kind::finished);
    CHECK(r.end(before).state == state_kind::finished);
}

TEST_CASE("while the system sleeps, a handle cancels a live stroke that waits")
{
    live_rig r;
    r.play(960);
    r.dac.suspend();
    r.step();
    r.control();
    REQUIRE(r.status().stage == engine::stream_stage::suspended);
    const stroke_id score = r.submit(tone(0.1));
    r.live->voice.request(engine::live_voice::action::cancel);
    CHECK(r.feed.cancel(score));
    r.step();
    r.control();
    CHECK(unheard_state(r, r.live->id) == state_kind::cancelled);
    CHECK(unheard_state(r, score) == state_kind::cancelled);
}

} // namespace waiting_test
