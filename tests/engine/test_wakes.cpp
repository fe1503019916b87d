// SPDX-License-Identifier: MIT
// Wake-ups of the control side by the audio thread: often enough to feed it, at once where the stream
// changes.
#include <doctest/doctest.h>

#include "live_rig.hpp"
#include "rig.hpp"

namespace wakes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

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

TEST_CASE(
    "a stroke longer than the horizon is fed to its end by a control side that sleeps until it is woken")
{
    rig r;
    const score s = random_score(1, 100);
    const stroke_id id = r.submit(s);
    REQUIRE(s.frames() > 10 * r.options.loop.horizon_frames);
    int periods = 0;
    int woken = 0;
    for (; !r.report(id) && periods < 10'000; ++periods) {
        if (wakes(r)) {
            r.control();
            ++woken;
        }
    }
    CHECK(r.end(id).state == state_kind::finished);
    CHECK(woken < periods / 10);
}

TEST_CASE("a stroke for a time before the stream's clock is known begins at that time")
{
    rig r;
    r.link.to_control.consume(); // that it has started
    r.control();
    // After the buffer's frames, and long before the feeder's next wake-up.
    const std::int64_t at_ns = r.now + 2 * 288 * std::int64_t{1'000'000'000} / rate;
    const stroke_id id = r.submit(tone(0.01), start_at::time(at_ns));
    for (int i = 0; i < 200 && !r.report(id); ++i)
        if (wakes(r))
            r.control();
    CHECK(r.end(id).late_s == 0.0);
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
    live_options o;
    o.timeout_s = 0.2;
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

} // namespace wakes_test
