// SPDX-License-Identifier: MIT
#include <algorithm>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "strokes.hpp"

namespace park_test {

using namespace tactor;
using namespace tactor::test;

namespace {

stroke across(double duration_s)
{
    return along("M 0 20 L 40 20", duration_s);
}

} // namespace

TEST_CASE("the four target motions give 21, 21, 31 and 31 bursts that never overlap")
{
    const unsigned counts[] = {21, 21, 31, 31};
    for (unsigned i = 0; i < 4; ++i) {
        const stroke s = preset_stroke(stroke_presets()[i]);
        const plan p = make_plan(palm, s);
        REQUIRE(p.bursts.size() == counts[i]);
        CHECK(p.algorithm == "park2016");
        CHECK(p.phantom == "inverse-distance");
        CHECK(p.carrier_hz == 250.0);
        CHECK(p.soa_s == 0.07);
        CHECK(p.conflicts.empty());
        CHECK(p.warnings.empty());
        CHECK_FALSE(p.at);
        CHECK(p.total_s == doctest::Approx(s.motion.duration_s() + 0.07).epsilon(1e-12));
        for (std::size_t k = 0; k < p.bursts.size(); ++k) {
            const burst& b = p.bursts[k];
            CHECK(b.onset_s == doctest::Approx(0.07 * static_cast<double>(k)).epsilon(1e-12));
            CHECK(b.duration_s == 0.07);
            CHECK(distance_mm(b.position, s.motion.position(b.onset_s)) < 1e-9);
            CHECK(b.intensity == 1.0);
            CHECK_FALSE(b.tau_s);
            CHECK(energy(b.drives) == doctest::Approx(1.0).epsilon(1e-12));
        }
    }
}

TEST_CASE("fixed: onsets at multiples of the SOA up to the end, one burst below one SOA")
{
    CHECK(make_plan(palm, across(0.0699)).bursts.size() == 1);
    CHECK(make_plan(palm, across(0.07)).bursts.size() == 2);
    CHECK(make_plan(palm, across(0.07 - 0.5e-9)).bursts.size() == 2);
    CHECK(make_plan(palm, across(0.07 - 2e-9)).bursts.size() == 1);
    CHECK(make_plan(palm, across(0.1399)).bursts.size() == 2);
    const plan one = make_plan(palm, across(0.01));
    CHECK(one.bursts[0].position == point{0.0, 20.0});
    CHECK(one.soa_s == 0.07);
    CHECK(one.total_s == 0.07);

    plan_options o;
    o.soa_s = 0.06;
    const plan p = make_plan(palm, across(1.0), o);
    CHECK(p.bursts.size() == 17);
    CHECK(p.bursts[3].duration_s == doctest::Approx((0.06 - 0.0473) / 0.32).epsilon(1e-12));
    CHECK(p.bursts[3].onset_s == doctest::Approx(0.18).epsilon(1e-12));
    CHECK(p.bursts[3].position.x_mm == doctest::Approx(7.2));
}

TEST_CASE("an SOA out of bounds is refused with both bounds")
{
    for (const double soa : {0.0473, 0.04, 0.0700001, 1.0, -1.0, 0.0, not_a_number, infinite}) {
        plan_options o;
        o.soa_s = soa;
        const std::string why = refusal(palm, across(1.0), o);
        CHECK(why.starts_with("--soa: "));
        CHECK(why.find("0.0473") != std::string::npos);
        CHECK(why.find("0.07 ") != std::string::npos);
        CHECK_THROWS_AS(burst_duration_s({}, soa), error);
    }
    CHECK(burst_duration_s({}, 0.07) == 0.07);
    CHECK(burst_duration_s({}, 0.0537) == doctest::Approx(0.02));
}

TEST_CASE("fit: both ends of the path are sampled, with the fewest intervals")
{
    plan_options o;
    o.schedule = timing::fit;
    generator g(21);
    for (unsigned i = 0; i < 2000; ++i) {
        const double duration = between(g, 0.28, 20.0);
        const plan p = make_plan(palm, across(duration), o);
        const std::size_t n = p.bursts.size() - 1;
        REQUIRE(*p.soa_s <= 0.07 + 1e-9);
        REQUIRE(duration / static_cast<double>(n - 1) > 0.07);
        REQUIRE(p.bursts.back().onset_s == doctest::Approx(duration).epsilon(1e-12));
        REQUIRE(distance_mm(p.bursts.front().position, {0.0, 20.0}) < 1e-9);
        REQUIRE(distance_mm(p.bursts.back().position, {40.0, 20.0}) < 1e-9);
        REQUIRE(p.conflicts.empty());
        REQUIRE(p.bursts[0].duration_s >= 0.02 - 1e-8);
        REQUIRE(p.bursts[0].duration_s == doctest::Approx(std::min((*p.soa_s - 0.0473) / 0.32, *p.soa_s)));
    }
    for (unsigned n = 1; n <= 500; ++n) {
        const plan p = make_plan(palm, across(n * 0.07), o);
        REQUIRE(p.bursts.size() == n + 1);
        REQUIRE(*p.soa_s == doctest::Approx(0.07).epsilon(1e-12));
    }
    CHECK(make_plan(palm, across(0.05), o).bursts.size() == 1);
    CHECK(make_plan(palm, across(0.05), o).soa_s == 0.07);
}

TEST_CASE("fit: where bursts would be too short the error names durations on both sides that work")
{
    plan_options o;
    o.schedule = timing::fit;
    generator g(22);
    unsigned refused = 0;
    for (unsigned i = 0; i < 3000; ++i) {
        if (i % 4 == 0)
            o.min_duration_s = between(g, 0.001, 0.0699);
        o.soa_s = 0.07;
        const double duration = between(g, 0.07, 1.0);
        const std::string why = refusal(palm, across(duration), o);
        if (why.empty())
            continue;
        ++refused;
        const double below = number_after(why, "work are ");
        const double above = number_after(why, " s and ");
        CAPTURE(why);
        REQUIRE(below < duration);
        REQUIRE(above > duration);
        REQUIRE(refusal(palm, across(below), o).empty());
        REQUIRE(refusal(palm, across(above), o).empty());
        REQUIRE_FALSE(refusal(palm, across(below + 1e-6), o).empty());
        REQUIRE_FALSE(refusal(palm, across(above - 1e-6), o).empty());
    }
    CHECK(refused > 500);

    o.min_duration_s = 0.1;
    CHECK_FALSE(refusal(palm, across(1.0), o).empty());
    o.min_duration_s = not_a_number;
    CHECK_FALSE(refusal(palm, across(1.0), o).empty());
}

TEST_CASE("another timing profile is used throughout")
{
    plan_options o;
    o.profile = {0.5, 0.03, 0.06};
    o.soa_s = 0.05;
    const plan p = make_plan(palm, across(1.0), o);
    CHECK(p.bursts.size() == 21);
    CHECK(p.bursts[0].duration_s == doctest::Approx(0.04));
    o.soa_s = 0.07;
    const std::string why = refusal(palm, across(1.0), o);
    CHECK(why.find("0.03") != std::string::npos);
    CHECK(why.find("0.06") != std::string::npos);
    for (const timing_profile bad : {timing_profile{0.0, 0.0473, 0.07},
                                     {1.0, 0.0473, 0.07},
                                     {not_a_number, 0.0473, 0.07},
                                     {0.32, -0.1, 0.07},
                                     {0.32, not_a_number, 0.07},
                                     {0.32, 0.0473, 0.0473},
                                     {0.32, 0.0473, infinite}}) {
        o.profile = bad;
        CHECK_FALSE(refusal(palm, across(1.0), o).empty());
    }
}

TEST_CASE("intensity over time sets A_v; none gives a burst without drives")
{
    const plan p = make_plan(palm, timed({{0.0, {0, 0}, 0.0}, {0.7, {40, 40}, 1.0}}));
    CHECK(p.bursts[0].drives.empty());
    CHECK(p.bursts[0].intensity == 0.0);
    CHECK(p.bursts[5].intensity == doctest::Approx(0.5));
    CHECK(energy(p.bursts[5].drives) == doctest::Approx(0.25));
}

} // namespace park_test
