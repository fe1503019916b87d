// SPDX-License-Identifier: MIT
// Strokes fed point by point, on the virtual clock: where, how loud and how late they sound.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "engine/live.hpp"
#include "has.hpp"
#include "rig.hpp"

namespace live_test {

using namespace tactor;
using namespace tactor::test;

namespace {

live_options with_wave(const char* name)
{
    live_options o;
    o.plan.wave = parse_waveform(name);
    return o;
}

// Returns a tenth of a second at the first tactor, after the first few milliseconds.
std::vector<double> heard(const live_options& o, double intensity = 1.0)
{
    live_rig r(o);
    r.live->to({0.0, 0.0}, intensity);
    r.play(4800 + 480);
    std::vector<double> s = r.channel(0, 480);
    s.resize(4800);
    return s;
}

double power(const std::vector<double>& s)
{
    double sum = 0.0;
    for (const double v : s)
        sum += v * v;
    return 2.0 * sum / static_cast<double>(s.size()) / (live_level * live_level);
}

/// Returns the time until the first frame that a point given now changes.
double ahead_s(live_rig& r)
{
    const engine::stream_status s = r.status();
    return static_cast<double>(s.written - s.played) / rate;
}

} // namespace

TEST_CASE("a live stroke is silent until its first point, then a sine at its tactor from the next period on")
{
    live_rig r;
    r.play(4800);
    CHECK_FALSE(r.first_sound());
    CHECK_FALSE(r.status().sounding);
    CHECK(r.live->to({0.0, 0.0}, 1.0));
    const std::uint64_t next = r.status().written;
    r.play(9600);
    CHECK(r.status().stroke == r.last());
    const auto sound = r.first_sound();
    REQUIRE(sound);
    CHECK(*sound <= next + 2);
    CHECK(*sound >= next);
    const auto s = r.channel(0, next);
    for (std::size_t i = 48; i < 9600; ++i)
        REQUIRE(s[i] == doctest::Approx(live_level *
                                        std::sin(2 * 3.14159265358979 * 250 * static_cast<double>(i) / rate))
                            .epsilon(1e-6)
                            .scale(0.1));
    for (unsigned c = 1; c < 9; ++c)
        CHECK(peak(r.channel(c)) == 0.0);
}

TEST_CASE("a live stroke whose level is given before it begins has no loud onset")
{
    live_rig r;
    CHECK(r.feed.set_gain(r.last(), 0.1F));
    r.live->to({0.0, 0.0}, 1.0);
    r.play(9600);
    CHECK(peak(r.channel(0)) == doctest::Approx(0.1 * live_level).epsilon(0.01));
}

TEST_CASE("a point sounds within a period and a control step, in every phase and size of period")
{
    for (const unsigned period : {16U, 48U, 96U, 480U, 1024U}) {
        CAPTURE(period);
        live_rig r({}, {.period = period});
        r.live->to({0.0, 0.0}, 1.0);
        r.play(period * 20);
        for (int i = 0; i < 20; ++i) {
            const bool here = i % 2 != 0;
            const std::uint64_t next = r.status().written;
            r.live->to({here ? 0.0 : 40.0, here ? 0.0 : 40.0}, 1.0);
            const unsigned channel = here ? 0 : 8;
            for (unsigned n = 0; n * period < 480 + 3 * period; ++n)
                r.play(period);
            const auto s = r.channel(channel, next);
            std::size_t first = 0;
            while (first < s.size() && s[first] == 0.0)
                ++first;
            CHECK(first <= period + 48 + 2);
            CHECK(peak(s, std::max(period, 48U) + 48, SIZE_MAX) > 0.5 * live_level);
        }
    }
}

TEST_CASE("samples do not jump when points do")
{
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> place(0.0, 40.0);
    for (const unsigned period : {16U, 96U, 480U}) {
        live_rig r({}, {.period = period});
        for (int i = 0; i < 2000; ++i) {
            r.live->to({place(random), place(random)}, static_cast<double>(random() % 2));
            r.play(period);
        }
        CHECK(r.finish().state == state_kind::finished);
        // The carrier's slope and a whole amplitude within a control step.
        const double allowed = live_level * (2 * 3.1416 * 250 / rate + 1.0 / 48);
        for (unsigned c = 0; c < 9; ++c)
            CHECK(largest_step(r.channel(c)) < allowed);
    }
}

TEST_CASE("a live stroke of bursts plays one each SOA, at the newest position, as long as the law says")
{
    live_options o = bursts();
    o.plan.soa_s = 0.06;
    live_rig r(o);
    r.live->to({0.0, 0.0}, 1.0);
    const std::uint64_t base = r.status().written;
    for (std::uint64_t f = 0; f < 20 * 2880; f += 96) {
        const auto n = (f + 96) / 2880; // of the next burst
        r.live->to({20.0 * static_cast<double>(n % 3), 0.0}, 1.0);
        r.play(96);
    }
    const auto duration = static_cast<std::size_t>(std::lround(burst_duration_s({}, 0.06) * rate));
    for (unsigned c = 0; c < 3; ++c) {
        const auto s = r.channel(c, base);
        for (std::size_t k = 0; k < 19; ++k) {
            CAPTURE(k);
            CAPTURE(c);
            const std::size_t at = k * 2880;
            CHECK((peak(s, at, at + duration) > 0.9 * live_level) == (k % 3 == c));
            CHECK(peak(s, at + duration, at + 2880) == 0.0);
        }
    }
    const auto report = r.finish();
    CHECK(report.state == state_kind::finished);
    CHECK(report.frames % 2880 == duration);
}

TEST_CASE("points in time keep a stroke of bursts alive, however seldom a burst takes one")
{
    live_options o = bursts();
    o.plan.soa_s = 0.6;
    o.plan.burst_s = 0.05;
    o.timeout_s = 0.5;
    live_rig r(o);
    for (int i = 0; i < 150; ++i) { // 3 s
        r.live->to({20.0, 20.0}, 1.0);
        r.play(960);
        REQUIRE_FALSE(r.report({1}));
    }
    // The time-out counts from the burst that took the last point.
    r.play(48000);
    r.play(9600);
    CHECK(r.end({1}).reason == reason_kind::starved);
}

TEST_CASE("bursts in a row on one tactor continue the stroke's sine, or each begins anew if asked for")
{
    for (const phase_kind phase : {phase_kind::stroke, phase_kind::burst}) {
        // At 255 Hz a burst has 17.85 cycles and ends anywhere: 2 ms of ramp.
        for (const double hz : {250.0, 255.0}) {
            live_options o = bursts();
            o.plan.carrier_hz = hz;
            o.render.phase = phase;
            live_rig r(o);
            r.live->to({0.0, 0.0}, 1.0);
            const std::uint64_t base = r.status().written;
            r.play(6 * 3360);
            const auto s = r.channel(0, base);
            REQUIRE(s.size() >= 6 * 3360);
            for (std::size_t k = 0; k < 6 * 3360; ++k) {
                const std::size_t place = k % 3360;
                if (hz != 250.0 && (place < 96 || place >= 3360 - 96))
                    continue;
                const auto at = static_cast<double>(phase == phase_kind::burst ? place : k);
                const double exact = live_level * std::sin(2 * 3.14159265358979 * hz * at / rate);
                REQUIRE(s[k] == doctest::Approx(exact).epsilon(1e-6).scale(0.1));
            }
            // Half way up and down the ramps.
            for (const std::size_t k : {std::size_t{48}, std::size_t{3360 - 48}, std::size_t{3360 + 48}}) {
                const double at = static_cast<double>(phase == phase_kind::burst ? k % 3360 : k);
                const double sine = live_level * std::sin(2 * 3.14159265358979 * hz * at / rate);
                CHECK(s[k] == doctest::Approx(hz == 250.0 ? sine : 0.5 * sine).epsilon(1e-4).scale(0.1));
            }
        }
    }
}

TEST_CASE("outside the array the nearest point plays and is counted, or is an error")
{
    live_rig r;
    CHECK(r.live->to({-50.0, 0.0}, 1.0));
    CHECK(r.live->to({10.0, 10.0}, 1.0));
    CHECK(r.live->to({1e300, -1e300}, 1.0));
    CHECK(r.live->points == 3);
    CHECK(r.live->to({-0.005, 0.0}, 1.0)); // on the edge, as far as anybody can draw
    CHECK(r.live->voice.outside_points() == 2);
    live_options strict;
    strict.plan.outside = outside_kind::error;
    auto s = r.add(strict);
    CHECK_THROWS_AS(s->to({-50.0, 0.0}, 1.0), error);
    CHECK(s->to({0.0, 0.0}, 1.0));
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {std::nan(""), inf, -inf}) {
        CHECK(caught_field([&] { r.live->to({bad, 0.0}, 1.0); }) == "x_mm");
        CHECK(caught_field([&] { r.live->to({0.0, bad}, 1.0); }) == "y_mm");
        CHECK(caught_field([&] { r.live->to({0.0, 0.0}, bad); }) == "intensity");
    }
    CHECK(caught_field([&] { r.live->to({0.0, 0.0}, -0.1); }) == "intensity");
    CHECK(r.live->to({0.0, 0.0}, 1e300)); // sounds like 1
    CHECK(r.live->limited_points == 0);
    r.play(9600);
    CHECK(peak(r.channel(0)) <= 2.0 * live_level * (1.0 + 1e-6)); // of two strokes
    for (const auto& stroke : {r.live, s})
        stroke->voice.request(engine::live_voice::action::end);
    r.play_out();
    CHECK(r.end({1}).outside_points == 2);
}

TEST_CASE("points in metres are reported when the stroke ends, points of a finger are not")
{
    for (const bool metres : {true, false}) {
        live_rig r;
        for (const double x : {5.0, 20.0, 35.0})
            CHECK(r.live->to({metres ? x / 1000.0 : x, 0.0}, 1.0));
        r.play(9600);
        CHECK(r.finish().doubt ==
              (metres
                   ? "all its places are within 0.035 mm of (0, 0): if they are metres, multiply them by 1000"
                   : ""));
    }
    // 40 mm to and fro at 8 m/s for two seconds.
    live_rig r;
    for (std::int64_t i = 0; i <= 400; ++i)
        CHECK(r.live->to({i % 2 == 0 ? 0.0 : 40.0, 0.0}, 1.0, 1 + i * 5'000'000));
    r.play(9600);
    CHECK(has(r.finish().doubt, "8000 mm/s, faster than a hand: if its places are micrometres"));
}

TEST_CASE("a point is held at its channel's limit, and counted")
{
    live_rig r;
    array a = palm();
    a.tactors[0].max_dbfs = -20.0;
    live_stroke::impl s({7}, a, layout(a), r.out->setup(), {});
    CHECK(s.to({0.0, 0.0}, 1.0));
    CHECK(s.to({40.0, 40.0}, 1.0));
    CHECK(s.limited_points == 1);
}

TEST_CASE("impossible options of a live stroke are errors that name their field")
{
    live_rig r;
    const auto refused = [&](const char* field, auto change) {
        live_options o = bursts();
        change(o);
        CHECK(caught_field([&] { r.add(o); }) == field);
        --r.last_id;
    };
    refused("algorithm", [](live_options& o) { o.plan.algorithm = algorithm_kind::tactile_brush; });
    refused("carrier_hz", [](live_options& o) { o.plan.carrier_hz = 24000.0; });
    refused("carrier_hz", [](live_options& o) { o.plan.carrier_hz = std::nan(""); });
    refused("soa_s", [](live_options& o) { o.plan.soa_s = 0.2; });
    refused("burst_s", [](live_options& o) { o.plan.burst_s = 0.0701; });
    refused("timeout_s", [](live_options& o) { o.timeout_s = 0.0; });
    refused("timeout_s", [](live_options& o) { o.timeout_s = std::nan(""); });
    for (const double bad : {0.0, -1.0, 86401.0, std::nan("")})
        refused("longest_s", [bad](live_options& o) { o.longest_s = bad; });
    for (const double bad : {-0.001, 1.001, std::nan("")})
        refused("smooth_s", [bad](live_options& o) { o.smooth_s = bad; });
    refused("level_dbfs", [](live_options& o) { o.render.level_dbfs = 3.0; });
    refused("sl_db", [](live_options& o) { o.render.sl_db = 7.0; });
    for (const double bad : {-1.0, 10.1})
        refused("ramp_s", [bad](live_options& o) { o.render.ramp_s = bad; });
    for (const double bad : {-1.0, 10.1, std::nan("")}) {
        refused("attack_s", [bad](live_options& o) { o.render.envelope.attack_s = bad; });
        refused("release_s", [bad](live_options& o) { o.render.envelope.release_s = bad; });
        refused("tukey_part", [bad](live_options& o) { o.render.envelope.tukey_part = bad; });
    }
    refused("level_db", [](live_options& o) { o.plan.scale.level_db = 6.0; });
    refused("texture", [](live_options& o) { // its path is not known
        o.plan.wave.kind = waveform_kind::recording;
        o.plan.wave.texture = texture_kind::length;
    });
    refused("soa_s", [](live_options& o) {
        o.plan.profile.intercept_s = 0.0;
        o.plan.soa_s = 0.001;
    });
}

TEST_CASE("live strokes vibrate with any wave, its peak at their level")
{
    const struct {
        const char* name;
        double least;
        double most;
    } waves[] = {
        {"sine", 0.99, 1.01},   {"square", 1.2, 1.7},        {"triangle", 0.6, 0.7},
        {"sawtooth", 0.4, 0.7}, {"noise:50-500", 0.02, 0.6},
    };
    for (const auto& w : waves) {
        CAPTURE(w.name);
        const std::vector<double> s = heard(with_wave(w.name));
        CHECK(peak(s) <= live_level * (1.0 + 1e-6));
        CHECK(power(s) > w.least);
        CHECK(power(s) < w.most);
    }
}

TEST_CASE("amplitude modulation goes down to the rest that its depth leaves")
{
    live_options o;
    o.plan.am = {50.0, 1.0};
    const std::vector<double> s = heard(o);
    double least = 1.0;
    for (std::size_t from = 0; from + 96 <= s.size(); from += 96) // half a cycle of the carrier
        least = std::min(least, peak(s, from, from + 96));
    CHECK(least < 0.1 * live_level);
    CHECK(peak(s) > 0.95 * live_level);
}

TEST_CASE("the intensity of a live point follows the scale")
{
    live_options o;
    CHECK(peak(heard(o, 0.5)) == doctest::Approx(0.5 * live_level).epsilon(1e-3));
    o.plan.scale = {scale_kind::stevens, 0.6, 0.0};
    CHECK(peak(heard(o, 0.5)) == doctest::Approx(std::pow(0.5, 1.0 / 0.6) * live_level).epsilon(1e-3));
    CHECK(peak(heard(o, 1.0)) == doctest::Approx(live_level).epsilon(1e-3));
}

TEST_CASE("a live stroke never exceeds its level, and points above it are counted")
{
    for (const algorithm_kind algorithm : {algorithm_kind::continuous, algorithm_kind::park2016})
        for (const scale_kind scale : {scale_kind::linear, scale_kind::sl, scale_kind::stevens})
            for (const double smooth_s : {0.0, 0.01}) {
                CAPTURE(smooth_s);
                live_options o;
                o.plan.algorithm = algorithm;
                o.plan.scale = {scale, 0.6, 7.0};
                o.smooth_s = smooth_s;
                live_rig r(o);
                r.live->to({0.0, 0.0}, 0.5);
                r.play(480);
                for (const double intensity : {80.0, 1.0, 1.001, 1e308})
                    r.live->to({0.0, 0.0}, intensity);
                r.play(9600);
                CHECK(peak(r.channel(0)) == doctest::Approx(live_level).epsilon(1e-3));
                CHECK(r.finish().held_points == 3);
            }
}

TEST_CASE("points above the ceiling count for a live stroke that never sounds, too")
{
    live_rig r;
    r.live->to({0.0, 0.0}, 2.0);
    CHECK(r.feed.cancel({1}));
    r.play_out();
    CHECK(r.end({1}).held_points == 1);
}

TEST_CASE("a live stroke whose object is gone leaves no sound behind")
{
    for (const char* wave : {"square", "noise:50-500"}) {
        live_options o = with_wave(wave);
        o.plan.algorithm = algorithm_kind::park2016;
        live_rig r(o);
        r.live->to({0.0, 0.0}, 1.0);
        r.play(4800);
        r.live->voice.request(engine::live_voice::action::end);
        r.live.reset();
        r.play_out();
        const std::vector<double> s = r.channel(0);
        REQUIRE(s.size() > 480);
        CHECK(peak(s, s.size() - 240, s.size()) == 0.0);
    }
}

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
    const auto report = r.finish();
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
    const auto report = r.finish();
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
    const auto report = r.finish();
    REQUIRE(report.delay);
    CHECK(report.delay->points == 2);
    CHECK(std::abs(report.delay->most_s - (buffered + 0.07 - 0.002)) < 2e-5);
}

TEST_CASE("without a sounding point there is no delay, and a time stamp is of CLOCK_MONOTONIC")
{
    live_rig r;
    CHECK_THROWS_AS(r.live->to({20.0, 20.0}, 1.0, -1), error);
    r.play(960);
    const auto silent = r.finish(engine::live_voice::action::cancel);
    CHECK_FALSE(silent.delay);

    const auto far = r.add();
    CHECK(far->to({20.0, 20.0}, 1.0, INT64_MAX)); // reported unchanged
    r.play(960);
    const auto report = r.finish(*far);
    REQUIRE(report.delay);
    CHECK(report.delay->most_s < -9e9);

    const stroke_id played = r.submit(tone(0.01));
    CHECK_FALSE(r.play_out(played).delay);
}

} // namespace live_test
