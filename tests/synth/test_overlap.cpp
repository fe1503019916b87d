// SPDX-License-Identifier: MIT
// Bursts that overlap on one tactor: one carrier, joined amplitudes.
#include <algorithm>
#include <cmath>
#include <utility>

#include <doctest/doctest.h>

#include "pieces.hpp"

namespace overlap_test {

using namespace tactor;
using namespace pieces;

namespace {

/// Makes two bursts of 0.1 s, overlapping from 0.06 s to 0.1 s, on tactor 0.
plan two_bursts(overlap_kind join, double a, double b, double a_v = 1.0)
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, a}}, a_v), make_burst(0.06, 0.1, {{0, b}}, a_v)});
    p.overlap = join;
    return p;
}

score make_score(const plan& p, double ramp_s)
{
    render_options o;
    o.level_dbfs = 0.0;
    o.ramp_s = ramp_s;
    o.phase = phase_kind::burst; // test_phase.cpp has the tests of the stroke's phase
    return {row(2), {{p, {}}}, o};
}

} // namespace

TEST_CASE("overlapping bursts share one carrier that starts with the first")
{
    struct rule {
        overlap_kind join;
        double a;
        double b;
        double both;
    };
    const rule rules[] = {{overlap_kind::energy, 0.6, 0.5, std::sqrt(0.61)},
                          {overlap_kind::energy, 0.9, 0.8, 1.0},
                          {overlap_kind::max, 0.6, 0.5, 0.6},
                          {overlap_kind::sum, 0.4, 0.5, 0.9}};
    for (const rule& r : rules) {
        const score s = make_score(two_bursts(r.join, r.a, r.b), 0.0);
        const auto x = channel(s, 0);
        REQUIRE(x.size() == 7680);
        for (std::size_t k = 0; k < x.size(); ++k) {
            const double a = k < 2880 ? r.a : (k < 4800 ? r.both : r.b);
            REQUIRE(std::abs(x[k] - a * std::sin(2.0 * pi * 250.0 * static_cast<double>(k) / 48000.0)) <
                    1e-6);
        }
    }
}

TEST_CASE("the largest intensity is that of any sounding burst, not only of the last")
{
    for (const bool louder_first : {true, false}) {
        CAPTURE(louder_first);
        plan p =
            make_plan({make_burst(0.0, 0.1, {{0, louder_first ? 0.9 : 0.5}}, louder_first ? 0.95 : 0.5),
                       make_burst(0.0, 0.1, {{0, louder_first ? 0.5 : 0.9}}, louder_first ? 0.5 : 0.95)});
        const auto x = channel(make_score(p, 0.0), 0);
        CHECK(x[48] == doctest::Approx(0.95)); // sqrt(0.81 + 0.25) would be more
        // An amplitude that a scale raised above the intensity may stay so.
        p.bursts[0].intensity = p.bursts[1].intensity = 0.3;
        CHECK(channel(make_score(p, 0.0), 0)[48] == doctest::Approx(0.9));
    }
}

TEST_CASE("a joined burst falls as smoothly as alone, however slowly it has risen")
{
    plan both = make_plan({make_burst(0.0, 0.1, {{0, 0.6}}), make_burst(0.06, 0.14, {{0, 0.6}})});
    both.overlap = overlap_kind::max;
    const plan alone = make_plan({make_burst(0.0, 0.2, {{0, 0.6}})});
    for (const auto& [attack_s, release_s] : {std::pair{0.05, 0.002}, {0.0, 0.002}, {0.002, 0.03}}) {
        CAPTURE(attack_s);
        render_options o;
        o.level_dbfs = 0.0;
        o.envelope = {.kind = envelope_kind::raised_cosine, .attack_s = attack_s, .release_s = release_s};
        const auto x = channel(score(row(1), both, o), 0);
        const auto y = channel(score(row(1), alone, o), 0);
        REQUIRE(x.size() == y.size());
        const auto last = static_cast<std::size_t>(48000 * release_s);
        const double near = last > 128 ? 0.6 * 0.002 : 1e-6; // long ones are drawn by 64 lines
        for (std::size_t k = x.size() - last; k < x.size(); ++k)
            REQUIRE(std::abs(x[k] - y[k]) < near);
    }
}

TEST_CASE("energy never exceeds the largest sounding intensity")
{
    plan p = make_plan({make_burst(0.0, 0.1, {{0, 0.5}}, 0.5), make_burst(0.06, 0.1, {{0, 0.5}}, 0.6)});
    const auto x = channel(make_score(p, 0.0), 0);
    CHECK(*std::max_element(x.begin() + 2880, x.begin() + 4800) == doctest::Approx(0.6));
    CHECK(*std::max_element(x.begin() + 4800, x.end()) == doctest::Approx(0.5));
}

TEST_CASE("ramps of overlapping bursts go into the joined amplitude, at the default length exactly")
{
    for (const std::int64_t ramp : {96, 480}) {
        const double a = 0.5;
        const double b = 0.4;
        for (const overlap_kind join : {overlap_kind::energy, overlap_kind::max, overlap_kind::sum}) {
            const score s = make_score(two_bursts(join, a, b), static_cast<double>(ramp) / 48000.0);
            const auto x = channel(s, 0);
            for (std::int64_t k = 0; k < 7680; ++k) {
                const double wa = k < 4800 ? a * window(k, 4800, ramp) : 0.0;
                const double wb = k >= 2880 ? b * window(k - 2880, 4800, ramp) : 0.0;
                double e = std::min(1.0, std::sqrt(wa * wa + wb * wb));
                e = join == overlap_kind::max ? std::max(wa, wb) : (join == overlap_kind::sum ? wa + wb : e);
                const double exact = e * std::sin(2.0 * pi * 250.0 * static_cast<double>(k) / 48000.0);
                REQUIRE(std::abs(x[static_cast<std::size_t>(k)] - exact) < (ramp == 96 ? 1e-6 : 2e-3));
            }
        }
    }
}

TEST_CASE("only the tactor with the overlap is joined")
{
    const plan p =
        make_plan({make_burst(0.01, 0.1, {{0, 0.6}, {1, 0.3}}), make_burst(0.06, 0.1, {{0, 0.5}})});
    const auto joined = channel(make_score(p, 0.0), 0);
    const auto single = channel(make_score(p, 0.0), 1);
    CHECK(joined[480 + 48] == doctest::Approx(0.6));
    CHECK(single[480 + 48] == doctest::Approx(0.3));
    CHECK(single[480 + 4800] == 0.0);
}

TEST_CASE("bursts that touch are not joined, each has its own phase")
{
    const double hz = 240.0;
    const plan p = make_plan({make_burst(0.0, 0.0710, {{0, 0.6}}), make_burst(0.0710, 0.05, {{0, 0.5}})}, hz);
    const auto x = channel(make_score(p, 0.0), 0);
    for (std::size_t k = 0; k < 2400; ++k) {
        REQUIRE(std::abs(x[3408 + k] - 0.5 * std::sin(2.0 * pi * hz * static_cast<double>(k) / 48000.0)) <
                1e-6);
    }
}

TEST_CASE("a long chain of overlaps is one carrier")
{
    std::vector<burst> bursts;
    for (int i = 0; i < 50; ++i)
        bursts.push_back(make_burst(0.04 * i, 0.1, {{0, 0.3}}));
    const score s = make_score(make_plan(bursts, 251.0), 0.0);
    const auto x = channel(s, 0);
    for (std::size_t k = 4800; k + 9600 < x.size(); ++k) {
        const std::size_t place = k % 1920;
        const double a = 0.3 * std::sqrt(place < 960 ? 3.0 : 2.0);
        REQUIRE(std::abs(x[k] - a * std::sin(2.0 * pi * 251.0 * static_cast<double>(k) / 48000.0)) < 1e-6);
    }
}

TEST_CASE("several plans in one score add, each with its own carrier")
{
    const plan a = make_plan({make_burst(0.0, 0.1, {{0, 0.3}})}, 250.0);
    const plan b = make_plan({make_burst(0.0, 0.1, {{0, 0.3}})}, 200.0);
    render_options o;
    o.level_dbfs = 0.0;
    const auto x = channel(score(row(1), {{a, 0.0}, {b, 0.0}}, o), 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double t = static_cast<double>(k) / 48000.0;
        REQUIRE(std::abs(x[k] - 0.3 * (std::sin(2.0 * pi * 250.0 * t) + std::sin(2.0 * pi * 200.0 * t))) <
                1e-6);
    }
}

} // namespace overlap_test
