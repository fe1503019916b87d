// SPDX-License-Identifier: MIT
// Delay of points of live strokes, from their time stamps to the DAC.
#include <cmath>
#include <cstdint>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "engine/live/live_stroke.hpp"
#include "live_rig.hpp"

using namespace tactor;
using namespace tactor::test;

namespace {

/// Returns the time until the first frame that a point given now changes.
double ahead_s(live_rig& r)
{
    const engine::stream_status s = r.status();
    return static_cast<double>(s.written - s.played) / rate;
}

/// Ends the stroke and plays it out.
stroke_report end_and_report(live_rig& r, live_stroke::impl& s,
                             engine::live_voice::action w = engine::live_voice::action::end)
{
    s.voice.request(w);
    r.play_out();
    return r.end(s.id);
}

} // namespace

TEST_CASE("a live stroke's report has the delay of its points to the DAC")
{
    live_rig r;
    r.play(9600); // the clock is well known now
    const double buffered = ahead_s(r);
    REQUIRE(buffered > 0.001);
    const auto point = [&](double x_mm, std::int64_t before_ns) {
        CHECK(r.live->to({x_mm, 20.0}, 1.0, r.now - before_ns));
        r.play(96);
    };
    point(20.0, 0);
    point(10.0, 3'000'000);
    point(0.0, 0);
    point(5.0, -1'000'000);                                    // by a clock that runs ahead
    CHECK(r.live->to({30.0, 20.0}, 1.0, r.now - 900'000'000)); // overtaken
    point(7.0, 0);
    const auto report = end_and_report(r, *r.live);
    REQUIRE(report.delay);
    CHECK(report.delay->points == 5);
    CHECK(std::abs(report.delay->least_s - (buffered - 0.001)) < 2e-5);
    CHECK(std::abs(report.delay->most_s - (buffered + 0.003)) < 2e-5);
    CHECK(std::abs(report.delay->mean_s - (buffered + 0.002 / 5)) < 2e-5);
}

TEST_CASE("a live stroke of one point has the delay of its first sample, even in a stream that just began")
{
    live_rig r;
    const std::int64_t stamp = r.now - 5'000'000;
    CHECK(r.live->to({20.0, 20.0}, 1.0, stamp));
    r.play(960);
    const auto report = end_and_report(r, *r.live);
    REQUIRE(report.started_ns);
    REQUIRE(report.delay);
    CHECK(report.delay->points == 1);
    const double s = 1e-9 * static_cast<double>(*report.started_ns - stamp);
    CHECK(report.delay->least_s == s);
    CHECK(report.delay->mean_s == s);
    CHECK(report.delay->most_s == s);
}

TEST_CASE("in a stroke of bursts a point's delay is to the burst that has it")
{
    live_rig r(bursts());
    r.play(9600);
    CHECK(r.live->to({20.0, 20.0}, 1.0, r.now));
    r.play(96);
    const double buffered = ahead_s(r);
    CHECK(r.live->to({0.0, 20.0}, 1.0, r.now)); // 70 ms after the first one's burst, 2 ms of which are over
    r.play(4800);
    const auto report = end_and_report(r, *r.live);
    REQUIRE(report.delay);
    CHECK(report.delay->points == 2);
    CHECK(std::abs(report.delay->most_s - (buffered + 0.07 - 0.002)) < 2e-5);
}

TEST_CASE("without a sounding point there is no delay, and a time stamp is of CLOCK_MONOTONIC")
{
    live_rig r;
    CHECK_THROWS_AS(r.live->to({20.0, 20.0}, 1.0, -1), error);
    r.play(960);
    const auto silent = end_and_report(r, *r.live, engine::live_voice::action::cancel);
    CHECK_FALSE(silent.delay);

    const auto far = r.add();
    CHECK(far->to({20.0, 20.0}, 1.0, INT64_MAX)); // reported unchanged
    r.play(960);
    const auto report = end_and_report(r, *far);
    REQUIRE(report.delay);
    CHECK(report.delay->most_s < -9e9);

    const stroke_id played = r.submit(tone(0.01));
    r.play_out();
    const auto other = r.end(played);
    CHECK_FALSE(other.delay);
}
