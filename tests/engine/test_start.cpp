// SPDX-License-Identifier: MIT
// Starts of strokes: when they are due, when they were felt.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "live_rig.hpp"
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

// Returns a period of the rig, ns: each step plays one, and the clock moves as much.
double period_ns(rig& r)
{
    return 1e9 * r.options.period / r.options.sample_rate;
}

// Returns the time of a frame of the current epoch at the virtual DAC, ns.
double true_time(rig& r, std::uint64_t frame)
{
    const auto ahead = static_cast<double>(frame) - static_cast<double>(r.status().played);
    return static_cast<double>(r.now) + ahead * 1e9 / r.options.sample_rate;
}

void check_started(rig& r, stroke_id id, double when)
{
    REQUIRE(r.end(id).started_ns);
    CHECK(std::abs(static_cast<double>(*r.end(id).started_ns) - when) < period_ns(r));
}

// A sink without a position as long as it is shy.
class shy_sink : public forwarding_sink {
public:
    shy_sink(std::unique_ptr<sink> s, const bool& shy) : forwarding_sink(std::move(s)), shy_(shy) {}
    stream_position position() noexcept override
    {
        stream_position p = forwarding_sink::position();
        p.valid = p.valid && !shy_;
        return p;
    }

private:
    const bool& shy_;
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

TEST_CASE("the first stroke of a player, submitted before the clock is known, has its start")
{
    for (const unsigned period : {32U, 96U, 1024U}) {
        CAPTURE(period);
        rig r({.period = period, .started = false});
        const stroke_id id = r.submit(tone(0.1));
        REQUIRE(r.start().status == io_kind::ok);
        CHECK_FALSE(r.link.clock.load().valid());
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s == 0.0);
        check_started(r, id, true_time(r, *r.first_sound() - 1)); // a sine begins with a zero
    }
}

TEST_CASE("a stroke as short as a frame or as a period has its start, one without sound has none")
{
    rig r;
    const stroke_id frame = r.submit(tone(1.0 / rate));
    const stroke_id period = r.submit(tone(96.0 / rate));
    const stroke_id nothing = r.submit(score(palm(), {}, {}));
    r.play_out();
    for (const stroke_id id : {frame, period})
        CHECK(r.end(id).started_ns.has_value());
    CHECK_FALSE(r.end(nothing).started_ns.has_value());
}

TEST_CASE("strokes that are cut report their start, those that never sounded report none")
{
    rig r({.started = false});
    const stroke_id cancelled = r.submit(tone(5.0));
    const stroke_id cut = r.submit(tone(5.0));
    const stroke_id waiting = r.submit(tone(0.1), start_at::frame(480'000));
    const stroke_id armed = r.submit(tone(0.1), start_at::trigger());
    REQUIRE(r.start().status == io_kind::ok);
    r.play(960);
    const double when = true_time(r, *r.first_sound() - 1);
    r.feed.cancel(cancelled);
    r.feed.cancel(waiting);
    r.feed.cancel(armed);
    r.play(4800);
    check_started(r, cancelled, when);
    CHECK(r.end(cancelled).state == state_kind::cancelled);
    r.dac.advance(4800); // runs dry
    r.play(960);
    check_started(r, cut, when);
    CHECK(r.end(cut).state == state_kind::interrupted);
    for (const stroke_id id : {waiting, armed})
        CHECK_FALSE(r.end(id).started_ns.has_value());
}

TEST_CASE("an xrun before the DAC's position was ever read keeps the start")
{
    bool shy = true;
    rig_options o;
    o.wrap = [&shy](std::unique_ptr<sink> s) { return std::make_unique<shy_sink>(std::move(s), shy); };
    rig r(o);
    const std::int64_t begin = r.now;
    const stroke_id id = r.submit(tone(5.0));
    r.play(960);
    const std::uint64_t first = *r.first_sound() - 1;
    r.dac.advance(4800);
    shy = false;
    r.play(960);
    CHECK(r.end(id).state == state_kind::interrupted);
    check_started(r, id, static_cast<double>(begin) + static_cast<double>(first) * 1e9 / rate);
}

TEST_CASE("the start of a stroke after an xrun is in the clock of its epoch")
{
    rig r;
    r.play(9600);
    r.dac.advance(4800); // runs dry, and stands for a second
    r.now += 1'000'000'000;
    const stroke_id id = r.submit(tone(0.1));
    const std::uint64_t from = r.dac.captured_frames();
    r.play(96);
    const std::uint64_t epoch = r.status().written - r.dac.captured_frames();
    r.play_out();
    check_started(r, id, true_time(r, epoch + *r.first_sound(from) - 1));
}

TEST_CASE("a live stroke reports when its first point was felt")
{
    live_rig r;
    r.play(960);
    CHECK(r.live->to({20.0, 20.0}, 1.0));
    r.play(960);
    r.live->voice.request(engine::live_voice::action::end);
    r.play_out();
    REQUIRE(r.first_sound());
    check_started(r, r.live->id, true_time(r, *r.first_sound() - 1));
}

} // namespace start_test
