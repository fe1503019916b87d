// SPDX-License-Identifier: MIT
// Carriers and levels of live strokes, on the virtual clock.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "live_rig.hpp"

namespace live_sound_test {

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

} // namespace

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
        CHECK(peak(s, 0, SIZE_MAX) <= live_level * (1.0 + 1e-6));
        CHECK(power(s) > w.least);
        CHECK(power(s) < w.most);
    }
}

TEST_CASE("a live stroke's noise depends on its seed alone")
{
    live_options o = with_wave("noise:50-500");
    const std::vector<double> one = heard(o);
    CHECK(heard(o) == one);
    o.plan.wave.seed = 2;
    CHECK(heard(o) != one);
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
    CHECK(peak(s, 0, SIZE_MAX) > 0.95 * live_level);
}

TEST_CASE("the intensity of a live point follows the scale")
{
    live_options o;
    CHECK(peak(heard(o, 0.5), 0, SIZE_MAX) == doctest::Approx(0.5 * live_level).epsilon(1e-3));
    o.plan.scale = {scale_kind::stevens, 0.6, 0.0};
    CHECK(peak(heard(o, 0.5), 0, SIZE_MAX) ==
          doctest::Approx(std::pow(0.5, 1.0 / 0.6) * live_level).epsilon(1e-3));
    CHECK(peak(heard(o, 1.0), 0, SIZE_MAX) == doctest::Approx(live_level).epsilon(1e-3));
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
                CHECK(peak(r.channel(0), 0, SIZE_MAX) == doctest::Approx(live_level).epsilon(1e-3));
                r.live->voice.request(engine::live_voice::action::end);
                r.play_out();
                CHECK(r.end({1}).state == state_kind::finished);
                CHECK(r.end({1}).held_points == 3);
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

TEST_CASE("a recording cannot lie along a path that is not known")
{
    live_options o;
    o.plan.wave.kind = waveform_kind::recording;
    o.plan.wave.texture = texture_kind::length;
    o.plan.wave.recorded = std::make_shared<const recording>(recording{"x", 8000.0, {0.5F, -0.5F}});
    live_rig r;
    CHECK_THROWS_WITH_AS(static_cast<void>(r.add(o)), doctest::Contains("length of its path"), error);
}

} // namespace live_sound_test
