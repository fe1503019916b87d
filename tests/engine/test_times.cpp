// SPDX-License-Identifier: MIT
// The DAC's clock, and starts of strokes: when they are due, when they were felt.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/dac_clock.hpp"
#include "rig.hpp"

namespace times_test {

using tactor::engine::clock_line;
using tactor::engine::dac_clock;
using namespace tactor;
using namespace tactor::test;

namespace {

// A DAC that is `ppm` too fast or slow.
struct truth {
    double ppm = 0.0;
    std::int64_t start_ns = 5'000'000'000'000;
    std::uint64_t first = 0;

    std::int64_t time_at(double frame) const
    {
        return start_ns +
               std::llround((frame - static_cast<double>(first)) * 1e9 / rate * (1.0 + ppm * 1e-6));
    }
    double frame_at(std::int64_t t) const
    {
        return static_cast<double>(first) +
               static_cast<double>(t - start_ns) * rate * 1e-9 / (1.0 + ppm * 1e-6);
    }
};

// Returns the largest error of the line over half a second from a frame on, ns.
double error_ns(const clock_line& line, const truth& t, std::uint64_t frame)
{
    double worst = 0.0;
    for (std::uint64_t f = frame; f <= frame + 24'000; f += 2400)
        worst = std::max(worst,
                         std::abs(static_cast<double>(line.time_at(f) - t.time_at(static_cast<double>(f)))));
    return worst;
}

} // namespace

TEST_CASE("with jitter up to 1 ms and drift up to 1000 ppm, the line stays within its stated bounds")
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> jitter(-1e6, 1e6);
    for (int round = 0; round < 60; ++round) {
        for (const double ppm : {-1000.0, -40.0, 0.0, 40.0, 1000.0}) {
            CAPTURE(ppm);
            const truth t{.ppm = ppm};
            dac_clock clock(48000, 0);
            clock.begin_epoch(0);
            double early = 0.0;
            for (std::uint64_t f = 48; f <= 10 * 48'000; f += 48) {
                clock.add(t.time_at(static_cast<double>(f)) + std::llround(jitter(random)), f);
                REQUIRE(clock.line().frame == f); // taken
                const auto here = std::abs(
                    static_cast<double>(clock.line().time_at(f) - t.time_at(static_cast<double>(f))));
                if (f > 4800)
                    early = std::max(early, here);
                if (f > 5 * 48'000) {
                    REQUIRE(here < 0.1e6);
                    REQUIRE(error_ns(clock.line(), t, f) < 0.15e6);
                }
            }
            CHECK(early < 0.5e6);
        }
    }
}

TEST_CASE("a position in whole periods, read at random times, is late by at most the time between readings")
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> gap(0.1e6, 0.9e6);
    for (const double ppm : {-40.0, 40.0}) {
        const truth t{.ppm = ppm};
        dac_clock clock(48000, 480);
        clock.begin_epoch(0);
        for (std::int64_t now = t.start_ns; now < t.start_ns + 30'000'000'000;
             now += std::llround(gap(random))) {
            const auto period = static_cast<std::uint64_t>(t.frame_at(now)) / 480 * 480;
            clock.add(now, period);
            REQUIRE(clock.line().frame == period); // taken
            if (now < t.start_ns + 10'000'000'000)
                continue;
            const auto late =
                static_cast<double>(clock.line().time_at(period) - t.time_at(static_cast<double>(period)));
            REQUIRE(late > -0.4e6);
            REQUIRE(late < 0.9e6);
        }
    }
}

TEST_CASE("single readings far off change nothing; when all are, the line begins anew")
{
    std::mt19937_64 random(8);
    const truth t{.ppm = 40.0};
    dac_clock clock(48000, 0);
    clock.begin_epoch(0);
    std::uint64_t f = 0;
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        f += 48;
        const bool wrong = i > 100 && random() % 10 == 0;
        clock.add(t.time_at(static_cast<double>(f)) + (wrong ? 30'000'000 : 0), f);
        refused += clock.line().frame != f ? 1 : 0;
        if (i > 1000)
            REQUIRE(error_ns(clock.line(), t, f) < 10e3);
    }
    CHECK(refused > 1000);
    const truth slept{.ppm = 40.0, .start_ns = t.start_ns + 3'000'000'000};
    for (int i = 0; i < 8; ++i) {
        f += 48;
        clock.add(slept.time_at(static_cast<double>(f)), f);
    }
    CHECK(std::abs(clock.line().time_at(f) - slept.time_at(static_cast<double>(f))) < 1000);
    CHECK(clock.line().valid());
}

TEST_CASE("each epoch begins without the one before")
{
    dac_clock clock(48000, 0);
    CHECK_FALSE(clock.line().valid());
    clock.begin_epoch(0);
    CHECK_FALSE(clock.line().valid());
    clock.add(1'000'000, 0); // nothing has moved
    CHECK_FALSE(clock.line().valid());
    clock.add(2'000'000, 48);
    CHECK(clock.line().valid());
    CHECK(clock.line().epoch == 1);
    CHECK(clock.line().time_at(96) == 3'000'000);
    clock.add(90'000'000, 48); // no news
    CHECK(clock.line().time_at(48) == 2'000'000);
    clock.begin_epoch(1000);
    CHECK_FALSE(clock.line().valid());
    CHECK(clock.line().epoch == 2);
    CHECK(clock.line().first == 1000);
    clock.add(500'000'000, 1048);
    CHECK(clock.line().time_at(1000) == 499'000'000);
    CHECK(clock.line().frame_at(501'000'000) == 1096);
}

TEST_CASE("extreme times and frames stay numbers")
{
    dac_clock clock(48000, 0);
    clock.begin_epoch(0);
    clock.add(1'000'000'000, 48'000);
    const clock_line& l = clock.line();
    using limits = std::numeric_limits<std::int64_t>;
    CHECK(l.frame_at(limits::min()) == 0);
    CHECK(l.frame_at(0) == 0);
    CHECK(l.frame_at(limits::max()) > std::uint64_t{1} << 48);
    CHECK(l.time_at(~std::uint64_t{0}) > limits::max() / 2);
    clock.add(limits::max(), 50'000);
    clock.add(limits::min(), 60'000);
    CHECK(l.frame == 48'000); // neither was taken
    CHECK(l.frame_at(l.time_at(123'456)) == 123'456);
}

namespace {

constexpr std::int64_t ms = 1'000'000;

// Returns options for a DAC that is 40 ppm slow: 80 ns of 2 ms.
rig_options slow(bool started = true)
{
    rig_options o{.started = started, .slow_ns = 80};
    return o;
}

// Returns a period of the rig, ns: each step plays one, and the clock moves as much.
double period_ns(const rig& r)
{
    return 1e9 * r.options.period / r.options.sample_rate + static_cast<double>(r.options.slow_ns);
}

// Returns the time of a frame of the current epoch at the virtual DAC, ns.
double true_time(rig& r, std::uint64_t frame)
{
    const auto ahead = static_cast<double>(frame) - static_cast<double>(r.status().played);
    return static_cast<double>(r.now) + ahead * period_ns(r) / r.options.period;
}

void check_started(rig& r, stroke_id id, double when)
{
    REQUIRE(r.end(id).started_ns);
    CHECK(std::abs(static_cast<double>(*r.end(id).started_ns) - when) < period_ns(r));
}

} // namespace

TEST_CASE("a start at a time puts the first sample at the DAC then, within a frame, however far ahead")
{
    std::mt19937_64 random(3);
    rig r(slow());
    r.play(500 * 96);
    for (int round = 0; round < 60; ++round) {
        const std::int64_t ahead = 9 * ms + static_cast<std::int64_t>(random() % 3'000'000'000);
        const std::int64_t due = r.now + ahead;
        const std::uint64_t from = r.dac.captured_frames();
        const stroke_id id = r.submit(tone(0.01), start_at::time(rt::to_time(due)));
        const stroke_report report = r.play_out(id);
        CHECK(report.state == state_kind::finished);
        CHECK(report.late_s == 0.0);
        const auto sound = r.first_sound(from);
        REQUIRE(sound);
        const double heard = true_time(r, *sound - 1); // a sine begins with a zero
        CHECK(std::abs(heard - static_cast<double>(due)) < 1.05e9 / rate);
        REQUIRE(report.started_ns);
        CHECK(std::abs(static_cast<double>(*report.started_ns) - heard) < 1e9 / rate);
        CHECK(report.first_frame == *sound - 1);
    }
}

TEST_CASE("a time that is over means now, and the lateness is reported")
{
    for (const std::int64_t ago :
         {std::int64_t{0}, 5 * ms, 100 * ms, std::int64_t{900'000'000'000}, INT64_MAX / 2}) {
        CAPTURE(ago);
        rig r(slow());
        r.play(100 * 96);
        const std::uint64_t next = r.status().written;
        const std::int64_t due = r.now - ago;
        const stroke_id id = r.submit(tone(0.01), start_at::time(rt::to_time(due)));
        r.play_out();
        CHECK(r.first_sound() == next + 1);
        CHECK(r.end(id).late_s ==
              doctest::Approx((true_time(r, next) - static_cast<double>(due)) / 1e9).epsilon(1e-3));
    }
}

TEST_CASE("a start a buffer and a period ahead is just in time")
{
    rig r(slow());
    r.play(100 * 96);
    const stroke_id id = r.submit(tone(0.01), start_at::time(rt::to_time(r.now + 8 * ms)));
    CHECK(r.play_out(id).late_s == 0.0);
}

TEST_CASE("a start at a time that is given before the clock is known waits for the clock")
{
    rig r(slow(false));
    const stroke_id id = r.submit(tone(0.01), start_at::time(rt::to_time(r.now + 300 * ms)));
    CHECK_FALSE(r.link.clock.load().valid());
    REQUIRE(r.start().status == io_kind::ok);
    const std::int64_t due = r.now + 300 * ms;
    CHECK(r.play_out(id).state == state_kind::finished);
    CHECK(std::abs(true_time(r, *r.first_sound() - 1) - static_cast<double>(due)) < 1.05e9 / rate);
}

TEST_CASE("a start at a frame that is over is late by the difference")
{
    rig r;
    r.play(9600);
    const std::uint64_t next = r.status().written;
    const stroke_id late = r.submit(tone(0.01), start_at::frame(next - 4800));
    const stroke_id good = r.submit(tone(0.01), next + 4800);
    const stroke_id now = r.submit(tone(0.01), start_at::now());
    CHECK(r.play_out(late).late_s == doctest::Approx(0.1));
    CHECK(r.end(good).late_s == 0.0);
    CHECK(r.end(now).late_s == 0.0);
}

TEST_CASE("armed strokes are silent until they are fired, and then start together at the given time")
{
    rig r(slow());
    const stroke_id a = r.submit(tone(0.02, 0), start_at::trigger());
    const stroke_id b = r.submit(tone(0.01, 4), start_at::trigger());
    r.play(2000 * 96);
    CHECK(r.ended.empty());
    CHECK(r.feed.knows(a));
    CHECK_FALSE(r.first_sound());
    const std::int64_t due = r.now + 50 * ms;
    CHECK(r.feed.fire(due) == 2);
    CHECK(r.feed.fire(due + 1) == 0);
    r.play_out();
    for (const stroke_id id : {a, b}) {
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s == 0.0);
        CHECK(std::abs(*r.end(id).started_ns - due) < 1'000'000'000 / rate);
    }
    CHECK(std::abs(true_time(r, *r.first_sound() - 1) - static_cast<double>(due)) < 1.05e9 / rate);
    // A stroke armed later waits for the next shot.
    const stroke_id c = r.submit(tone(0.01), start_at::trigger());
    r.play(100 * 96);
    CHECK(r.ended.size() == 2);
    CHECK(r.feed.fire(r.now - 20 * ms) == 1);
    CHECK(r.play_out(c).late_s > 0.020);
}

TEST_CASE("armed strokes can be cancelled before and after they are fired, and end with the stream")
{
    for (const bool closing : {false, true}) {
        rig r;
        const stroke_id a = r.submit(tone(0.1), start_at::trigger());
        const stroke_id b = r.submit(tone(0.1), start_at::trigger());
        const stroke_id c = r.submit(tone(0.1), start_at::time(rt::to_time(r.now + 3600'000 * ms)));
        CHECK(r.feed.cancel(a));
        CHECK_FALSE(r.feed.cancel(a));
        r.play(960);
        CHECK(r.feed.fire(r.now + 1000 * ms) == 1);
        CHECK(r.feed.cancel(b));
        CHECK(r.feed.cancel(c));
        const stroke_id d = r.submit(tone(0.1), start_at::trigger());
        const stroke_id e = r.submit(tone(0.1), start_at::time(rt::to_time(r.now + 3600'000 * ms)));
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
    CHECK(r.play_out(id).state == state_kind::finished);
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
        CHECK(r.play_out(id).state == state_kind::finished);
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
    for (const stroke_id id : {frame, period}) {
        CHECK(r.end(id).started_ns.has_value());
        CHECK(r.end(id).first_frame.has_value());
    }
    CHECK_FALSE(r.end(nothing).started_ns.has_value());
    CHECK_FALSE(r.end(nothing).first_frame.has_value());
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
    o.wrap = [&shy](std::unique_ptr<sink> s) {
        return std::make_unique<position_sink>(std::move(s),
                                               [&shy](stream_position& p) { p.valid = p.valid && !shy; });
    };
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
    r.finish();
    REQUIRE(r.first_sound());
    check_started(r, r.live->id, true_time(r, *r.first_sound() - 1));
}

} // namespace times_test
