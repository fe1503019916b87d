// SPDX-License-Identifier: MIT
// Starts of strokes: at a frame, at a time, or when triggered. Time is virtual.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "rig.hpp"

namespace start_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr std::int64_t ms = 1'000'000;

// A rig whose DAC is 40 ppm slow.
class slow_rig : public rig {
public:
    using rig::rig;

    void run(unsigned periods)
    {
        for (unsigned i = 0; i < periods && !loop.over(); ++i) {
            now += 80; // of 2 ms
            play(96);
        }
    }
    void run_out()
    {
        for (int i = 0; i < 100'000 && ended.size() < last_id && !loop.over(); ++i)
            run(1);
    }
    /// Returns the true time of a frame of the first epoch at the DAC, ns.
    double true_time(std::uint64_t frame)
    {
        const auto ahead = static_cast<double>(static_cast<std::int64_t>(frame - status().played));
        return static_cast<double>(now) + ahead * (2e6 + 80.0) / 96.0;
    }
};

} // namespace

TEST_CASE("a start at a time puts the first sample at the DAC then, within a frame, however far ahead")
{
    std::mt19937_64 random(3);
    slow_rig r;
    r.run(500);
    for (int round = 0; round < 60; ++round) {
        const std::int64_t ahead = 9 * ms + static_cast<std::int64_t>(random() % 3'000'000'000);
        const std::int64_t due = r.now + ahead;
        const std::uint64_t from = r.dac.captured_frames();
        const stroke_id id = r.submit(tone(0.01), start_at::time(due));
        r.run_out();
        const stroke_report report = r.end(id);
        CHECK(report.state == state_kind::finished);
        CHECK(report.late_s == 0.0);
        const auto sound = r.first_sound(from);
        REQUIRE(sound);
        const double heard = r.true_time(*sound - 1); // a sine begins with a zero
        CHECK(std::abs(heard - static_cast<double>(due)) < 1.05e9 / rate);
        REQUIRE(report.started_ns);
        CHECK(std::abs(static_cast<double>(*report.started_ns) - heard) < 1e9 / rate);
    }
}

TEST_CASE("a time that is over means now, and the lateness is reported")
{
    for (const std::int64_t ago :
         {std::int64_t{0}, 5 * ms, 100 * ms, std::int64_t{900'000'000'000}, INT64_MAX / 2}) {
        CAPTURE(ago);
        slow_rig r;
        r.run(100);
        const std::uint64_t next = r.status().written;
        const std::int64_t due = r.now - ago;
        const stroke_id id = r.submit(tone(0.01), start_at::time(due));
        r.run_out();
        CHECK(r.first_sound() == next + 1);
        CHECK(r.end(id).late_s ==
              doctest::Approx((r.true_time(next) - static_cast<double>(due)) / 1e9).epsilon(1e-3));
    }
}

TEST_CASE("a start a buffer and a period ahead is just in time")
{
    slow_rig r;
    r.run(100);
    const stroke_id id = r.submit(tone(0.01), start_at::time(r.now + 8 * ms));
    r.run_out();
    CHECK(r.end(id).late_s == 0.0);
}

TEST_CASE("a start at a time that is given before the clock is known waits for the clock")
{
    slow_rig r({.started = false});
    const stroke_id id = r.submit(tone(0.01), start_at::time(r.now + 300 * ms));
    CHECK_FALSE(r.link.clock.load().valid());
    REQUIRE(r.start().status == io_kind::ok);
    const std::int64_t due = r.now + 300 * ms;
    r.run_out();
    CHECK(r.end(id).state == state_kind::finished);
    CHECK(std::abs(r.true_time(*r.first_sound() - 1) - static_cast<double>(due)) < 1.05e9 / rate);
}

TEST_CASE("a start at a frame that is over is late by the difference")
{
    rig r;
    r.play(9600);
    const std::uint64_t next = r.status().written;
    const stroke_id late = r.submit(tone(0.01), start_at::frame(next - 4800));
    const stroke_id good = r.submit(tone(0.01), next + 4800);
    const stroke_id now = r.submit(tone(0.01), start_at::now());
    r.play_out();
    CHECK(r.end(late).late_s == doctest::Approx(0.1));
    CHECK(r.end(good).late_s == 0.0);
    CHECK(r.end(now).late_s == 0.0);
}

TEST_CASE("armed strokes are silent until they are fired, and then start together at the given time")
{
    slow_rig r;
    const stroke_id a = r.submit(tone(0.02, 0), start_at::trigger());
    const stroke_id b = r.submit(tone(0.01, 4), start_at::trigger());
    r.run(2000);
    CHECK(r.ended.empty());
    CHECK(r.feed.knows(a));
    CHECK_FALSE(r.first_sound());
    const std::int64_t due = r.now + 50 * ms;
    CHECK(r.feed.fire(due) == 2);
    CHECK(r.feed.fire(due + 1) == 0);
    r.run_out();
    for (const stroke_id id : {a, b}) {
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s == 0.0);
        CHECK(std::abs(*r.end(id).started_ns - due) < 1'000'000'000 / rate);
    }
    CHECK(std::abs(r.true_time(*r.first_sound() - 1) - static_cast<double>(due)) < 1.05e9 / rate);
    // A stroke armed later waits for the next shot.
    const stroke_id c = r.submit(tone(0.01), start_at::trigger());
    r.run(100);
    CHECK(r.ended.size() == 2);
    CHECK(r.feed.fire(r.now - 20 * ms) == 1);
    r.run_out();
    CHECK(r.end(c).late_s > 0.020);
}

TEST_CASE("armed strokes can be cancelled before and after they are fired, and end with the stream")
{
    for (const bool closing : {false, true}) {
        rig r;
        const stroke_id a = r.submit(tone(0.1), start_at::trigger());
        const stroke_id b = r.submit(tone(0.1), start_at::trigger());
        const stroke_id c = r.submit(tone(0.1), start_at::time(r.now + 3600'000 * ms));
        CHECK(r.feed.cancel(a));
        CHECK_FALSE(r.feed.cancel(a));
        r.play(960);
        CHECK(r.feed.fire(r.now + 1000 * ms) == 1);
        CHECK(r.feed.cancel(b));
        CHECK(r.feed.cancel(c));
        const stroke_id d = r.submit(tone(0.1), start_at::trigger());
        const stroke_id e = r.submit(tone(0.1), start_at::time(r.now + 3600'000 * ms));
        r.stop(closing);
        r.play(9600);
        r.control();
        for (const stroke_id id : {a, b, c})
            CHECK(r.end(id).state == state_kind::cancelled);
        for (const stroke_id id : {d, e})
            CHECK(r.end(id).state == (closing ? state_kind::interrupted : state_kind::cancelled));
        CHECK_FALSE(r.first_sound());
    }
}

TEST_CASE("an xrun between the shot and the start keeps the time, in the new epoch's frames")
{
    rig r;
    r.play(9600);
    const stroke_id id = r.submit(tone(0.01), start_at::trigger());
    const std::int64_t due = r.now + 200 * ms;
    r.feed.fire(due);
    r.play(960);
    r.dac.advance(1000); // dry, with the stroke already in the audio thread
    r.now += 30 * ms;
    r.step();
    r.play_out();
    CHECK(r.end(id).state == state_kind::finished);
    CHECK(r.end(id).late_s == 0.0);
    CHECK(r.link.clock.load().epoch == 2);
    CHECK(std::abs(*r.end(id).started_ns - due) < 2'000'000'000 / rate);
}

} // namespace start_test
