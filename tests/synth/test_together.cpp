// SPDX-License-Identifier: MIT
// Strokes that meet on a tactor: the level asked for is the most that any tactor reaches.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "mixes.hpp"
#include "own_curve.hpp"
#include "pieces.hpp"
#include "rounds.hpp"

namespace together_test {

using namespace tactor;
using namespace pieces;

namespace {

double db(double ratio)
{
    return 20.0 * std::log10(ratio);
}

double linear(double db)
{
    return std::pow(10.0, db / 20.0);
}

double peak(const score& s, unsigned c)
{
    double p = 0.0;
    for (const double x : channel(s, c))
        p = std::max(p, std::abs(x));
    return p;
}

plan steady(double duration_s, double amplitude = 1.0, double carrier_hz = 250.0)
{
    return make_plan({make_burst(0.0, duration_s, {{0, amplitude}}, amplitude)}, carrier_hz);
}

/// Makes a continuous stroke on one tactor, from 0 up to an amplitude in the middle and down to 0.
plan tent(double duration_s, double amplitude)
{
    plan p = make_continuous(1, duration_s);
    p.curve = test::make_curve(duration_s, [=](double t, burst& out) {
        out.drives = {{0, amplitude * (1.0 - std::abs(2.0 * t / duration_s - 1.0))}};
    });
    return p;
}

/// Makes three lines that cross at the middle of nine tactors at one time.
std::vector<placed_plan> crossing(algorithm_kind algorithm)
{
    std::vector<placed_plan> all;
    for (const char* data : {"M 0 20 H 40", "M 40 20 H 0", "M 20 0 V 40"}) {
        const stroke line{.motion = trajectory::along(path::from_svg(data), 1.4)};
        all.push_back({make_plan(preset_array("palm-3x3"), line, {.algorithm = algorithm}), 0.0, {}});
    }
    return all;
}

} // namespace

TEST_CASE("strokes that cross on a tactor reach the level asked for there, and none is above it")
{
    const array palm = preset_array("palm-3x3");
    for (const algorithm_kind algorithm : {algorithm_kind::park2016, algorithm_kind::continuous}) {
        CAPTURE(to_string(algorithm));
        const auto plans = crossing(algorithm);
        const score s(palm, plans, {.level_dbfs = -40.0});
        CHECK(s.weakened().weakened_db == doctest::Approx(-db(3.0)).epsilon(1e-6));
        CHECK(s.weakened().tactor == 4);
        CHECK(s.weakened().at_s == doctest::Approx(0.7).epsilon(0.05));
        CHECK(s.weakened().plans == std::vector<std::size_t>{0, 1, 2});
        for (unsigned c = 0; c < 9; ++c)
            CHECK(db(peak(s, c)) <= -40.0 + 1e-6);
        CHECK(db(peak(s, 4)) == doctest::Approx(-40.0).epsilon(1e-3));
        const score as_is(palm, plans, {.level_dbfs = -40.0, .together = together_kind::sum});
        CHECK(as_is.weakened().weakened_db == 0.0);
        CHECK(db(peak(as_is, 4)) == doctest::Approx(-30.46).epsilon(1e-3));
        // The factor is the same for the whole piece.
        for (const unsigned c : {0U, 1U, 3U, 4U}) {
            const auto x = channel(s, c);
            const auto y = channel(as_is, c);
            for (std::size_t k = 0; k < x.size(); ++k)
                REQUIRE(std::abs(3.0 * x[k] - y[k]) < 1e-8);
        }
    }
}

TEST_CASE("what does not exceed the level is not weakened")
{
    const plan half = steady(0.2, 0.5);
    for (const unsigned rate : {8000U, 22050U, 44100U, 48000U, 96000U}) {
        CAPTURE(rate);
        const render_options o{.rate = rate};
        CHECK(score(row(1), steady(0.2), o).weakened().weakened_db == 0.0);
        CHECK(score(row(1), {{half, 0.0, {}}, {half, 0.0, {}}}, o).weakened().weakened_db == 0.0);
        // Strokes that follow each other only touch.
        std::vector<placed_plan> chain;
        for (int i = 0; i < 20; ++i)
            chain.push_back({steady(0.07 + 0.0001 * i), {}, {}});
        CHECK(score(row(1), chain, o).weakened().weakened_db == 0.0);
    }
    const array palm = preset_array("palm-3x3");
    for (const char* name : {"park2016-1", "park2016-2", "park2016-3", "park2016-4"})
        for (const algorithm_kind algorithm : {algorithm_kind::park2016, algorithm_kind::continuous}) {
            const plan p = make_plan(palm, preset_stroke(name), {.algorithm = algorithm});
            CHECK(score(palm, p).weakened().weakened_db == 0.0);
        }
}

TEST_CASE("ramps count with their height where they meet")
{
    render_options o;
    o.envelope = {.kind = envelope_kind::linear, .attack_s = 0.5, .release_s = 0.5};
    const auto weakened = [&](double start_s) {
        return score(row(1), {{steady(1.5), 0.0, {}}, {steady(1.5), start_s, {}}}, o).weakened();
    };
    // The second rises as the first falls: their sum is 1 all the time.
    CHECK(weakened(1.0).weakened_db == 0.0);
    // Half a ramp earlier, one is at a half when the other begins to fall.
    CHECK(weakened(0.75).weakened_db == doctest::Approx(-db(1.5)).epsilon(1e-3));
    CHECK(weakened(0.75).at_s == doctest::Approx(1.0).epsilon(1e-3));
    CHECK(weakened(0.25).weakened_db == doctest::Approx(-db(2.0)).epsilon(1e-3));
    CHECK(weakened(1.5).weakened_db == 0.0);
}

TEST_CASE("continuous strokes count with what they drive at a time")
{
    // Two tents of 1 s, the second half a second later, have a sum that stays at their height.
    const auto weakened = [](double height, double start_s) {
        return score(row(1), {{tent(1.0, height), 0.0, {}}, {tent(1.0, height), start_s, {}}})
            .weakened()
            .weakened_db;
    };
    CHECK(weakened(1.0, 0.5) == 0.0);
    CHECK(weakened(1.0, 0.0) == doctest::Approx(-db(2.0)).epsilon(1e-4));
    CHECK(weakened(1.0, 0.25) == doctest::Approx(-db(1.5)).epsilon(1e-3));
    CHECK(weakened(0.5, 0.0) == 0.0);
}

TEST_CASE("carriers that differ count with the sum of their amplitudes, which their beat reaches")
{
    const score s(row(1), {{steady(2.0, 1.0, 250.0), 0.0, {}}, {steady(2.0, 0.5, 240.0), 0.0, {}}});
    CHECK(s.weakened().weakened_db == doctest::Approx(-db(1.5)));
    CHECK(db(peak(s, 0)) == doctest::Approx(-12.0).epsilon(0.01));
    CHECK(db(peak(s, 0)) <= -12.0 + 1e-6);
}

TEST_CASE("bursts of one stroke that add up are weakened, too")
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, 0.8}}), make_burst(0.05, 0.1, {{0, 0.8}})});
    CHECK(score(row(1), p).weakened().weakened_db == 0.0);
    p.overlap = overlap_kind::sum;
    const score s(row(1), p);
    CHECK(s.weakened().weakened_db == doctest::Approx(-db(1.6)));
    CHECK(s.weakened().plans == std::vector<std::size_t>{0});
    CHECK(db(peak(s, 0)) == doctest::Approx(-12.0).epsilon(1e-3));
    // An amplitude above 1, which a program may have made.
    CHECK(score(row(1), steady(0.1, 2.0)).weakened().weakened_db == doctest::Approx(-db(2.0)));
}

TEST_CASE("the gain of a tactor and its threshold come with the level that is asked for")
{
    array a = row(1);
    a.tactors[0].gain_db = -6.0;
    a.tactors[0].threshold_dbfs = -40.0;
    const std::vector<placed_plan> both{{steady(0.2), 0.0, {}}, {steady(0.2), 0.0, {}}};
    const score s(a, both, {.level_dbfs = -20.0});
    CHECK(s.weakened().weakened_db == doctest::Approx(-db(2.0)));
    CHECK(db(peak(s, 0)) == doctest::Approx(-26.0));
    const score felt(a, both, {.sl_db = 10.0});
    CHECK(felt.weakened().weakened_db == doctest::Approx(-db(2.0)));
    CHECK(db(peak(felt, 0)) == doctest::Approx(-30.0));
    a.tactors[0].thresholds = {{100.0, -20.0}, {250.0, -40.0}};
    const score other(a, {{steady(0.2, 1.0, 100.0), 0.0, {}}, {steady(0.2, 1.0, 100.0), 0.0, {}}},
                      {.sl_db = 10.0});
    CHECK(other.weakened().weakened_db == doctest::Approx(-db(2.0)));
    CHECK(db(peak(other, 0)) == doctest::Approx(-10.0));
}

TEST_CASE("weakened strokes are held to a tactor's limit by what they reach, sums by what they may reach")
{
    array a = row(1);
    a.tactors[0].max_dbfs = -12.0;
    const std::vector<placed_plan> both{{tent(1.0, 1.0), 0.0, {}}, {tent(1.0, 1.0), 0.5, {}}};
    CHECK(score(a, both).weakened().weakened_db == 0.0);
    a.tactors[0].max_dbfs = -12.1;
    has(caught_message([&] { score(a, both); }), "tactor 0: it would play at -12 dBFS");
    const std::vector<placed_plan> crest{{steady(0.2), 0.0, {}}, {steady(0.2), 0.0, {}}};
    a.tactors[0].max_dbfs = -12.0;
    CHECK(caught_message([&] { score(a, crest); }).empty());
    has(caught_message([&] { score(a, crest, {.together = together_kind::sum}); }),
        "tactor 0: it would play at -5.979 dBFS");
    // Strokes that are within the limit by their intensity may exceed it where they meet.
    const std::vector<placed_plan> halves{{steady(0.2, 0.5), 0.0, {}}, {steady(0.2, 0.5), 0.1, {}}};
    a.tactors[0].max_dbfs = -10.0;
    const score held(a, halves, {.level_dbfs = -6.0});
    CHECK(held.weakened().weakened_db == doctest::Approx(-4.0));
    CHECK(held.weakened().plans == std::vector<std::size_t>{0, 1});
    CHECK(held.weakened().at_s == doctest::Approx(0.1).epsilon(1e-3));
    CHECK(db(peak(held, 0)) == doctest::Approx(-10.0).epsilon(1e-3));
    CHECK(db(peak(held, 0)) <= -10.0 + 1e-6);
}

TEST_CASE("markers do not count, and keep their height")
{
    const score s(row(1), {{steady(0.2), 0.0, {}}, {steady(0.2), 0.0, {}}},
                  {.channels = 2, .marker_channel = 1U});
    CHECK(s.weakened().weakened_db == doctest::Approx(-db(2.0)));
    CHECK(peak(s, 1) == 1.0);
}

TEST_CASE("no sample of random mixes is above the level asked for")
{
    int weakened = 0;
    const int all = test::rounds(200, 5'000);
    for (int n = 0; n < all; ++n) {
        CAPTURE(n);
        mixes::mix m = mixes::some_mix(static_cast<std::uint64_t>(n));
        m.options.together = together_kind::weaken;
        m.options.limits.reset();
        m.options.sl_db.reset();
        for (tactor_spec& t : m.tactors.tactors) {
            t.max_dbfs = 0.0;
            t.rise_s.reset();
        }
        try {
            const score s(m.tactors, m.plans, m.options);
            weakened += s.weakened().weakened_db < 0.0 ? 1 : 0;
            const std::vector<std::byte> samples = render(s, format_kind::float32);
            for (const tactor_spec& t : m.tactors.tactors) {
                double most = 0.0;
                for (std::size_t k = t.channel; k < samples.size() / sizeof(float); k += s.channels())
                    most = std::max(most, std::abs(static_cast<double>(sample<float>(samples, k))));
                CHECK(most <= linear(m.options.level_dbfs + t.gain_db) * (1.0 + 1e-6));
            }
        } catch (const error& e) {
            has(std::string(e.what()), "slow displacement");
        }
    }
    CHECK(weakened > all / 5);
}

} // namespace together_test
