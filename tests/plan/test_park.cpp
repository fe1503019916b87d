// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "has.hpp"
#include "rounds.hpp"
#include "strokes.hpp"

namespace park_test {

using namespace tactor;
using namespace tactor::test;

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
        CHECK_FALSE(p.curve);
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

TEST_CASE("a burst with a given duration keeps the SOA, up to the SOA, and warns where it leaves the law")
{
    struct example {
        double soa_s;
        double burst_s;
        bool law;
    };
    const example all[] = {{0.07, 0.07, true},  {0.06, 0.0397, true}, {0.07, 0.05, false},
                           {0.06, 0.06, false}, {0.5, 0.1, false},    {0.03, 0.01, false},
                           {10.0, 0.1, false},  {0.05, 0.0084, true}, {0.07, 1e-4, false}};
    for (const example& e : all) {
        plan_options o{.soa_s = e.soa_s, .burst_s = e.burst_s, .carrier_hz = 10000.0};
        const plan p = make_plan(palm, across(1.0), o);
        CAPTURE(e.soa_s);
        CAPTURE(e.burst_s);
        CHECK(burst_duration_s(o) == e.burst_s);
        CHECK(p.soa_s == e.soa_s);
        REQUIRE_FALSE(p.bursts.empty());
        CHECK(p.bursts.size() == static_cast<std::size_t>(1.0 / e.soa_s + 1e-9) + 1);
        CHECK(p.bursts.back().duration_s == e.burst_s);
        CHECK(p.total_s == p.bursts.back().onset_s + e.burst_s);
        CHECK(p.conflicts.empty());
        REQUIRE(p.warnings.size() == (e.law ? 0 : 1));
        if (!e.law)
            has(p.warnings[0], "break the timing law, SOA = 0.32 duration + 0.0473 s");
    }
}

TEST_CASE("a plan that leaves the timing law, or its fitted range, says so in figures")
{
    plan_options o{.burst_s = 0.05};
    CHECK(make_plan(palm, across(1.0), o).warnings ==
          std::vector<std::string>{
              "bursts of 0.05 s every 0.07 s break the timing law, SOA = 0.32 duration + 0.0473 s, which "
              "gives them an SOA of 0.0633 s: people may not feel one motion"});
    o.soa_s = 2.0;
    o.burst_s = 0.161;
    const auto warnings = make_plan(palm, across(1.0), o).warnings;
    REQUIRE(warnings.size() == 2);
    CHECK(warnings[0] == "1 of 1 burst lasts longer than 0.160 s (up to 0.161 s), beyond the range for which "
                         "the timing law was fitted");
    CHECK(warnings[1].find("which gives them an SOA of 0.09882 s:") != std::string::npos);
    o.burst_s = 0.160;
    CHECK(make_plan(palm, across(1.0), o).warnings.size() == 1);
    // By the law 39.6875 ms: a duration is printed to the millisecond.
    o.soa_s = 0.06;
    for (const auto& [burst_s, told] : {std::pair{0.0401, 0U}, {0.0402, 1U}, {0.0392, 0U}, {0.0391, 1U}}) {
        CAPTURE(burst_s);
        o.burst_s = burst_s;
        CHECK(make_plan(palm, across(1.0), o).warnings.size() == told);
    }
}

TEST_CASE("an impossible burst is refused with the possible ones")
{
    plan_options o;
    for (const double s : {0.0701, 1.0, 1e300}) {
        o.burst_s = s;
        CHECK(refusal(palm, across(1.0), o).find("longer than the SOA of 0.07 s") != std::string::npos);
    }
    for (const double s : {0.0, -0.01, 1e-5, not_a_number, infinite, -infinite}) {
        o.burst_s = s;
        CHECK(refusal(palm, across(1.0), o).starts_with("burst_s: "));
    }
    o.burst_s = 0.05;
    for (const double s : {0.0, -1.0, 10.1, not_a_number, infinite}) {
        o.soa_s = s;
        CHECK(refusal(palm, across(1.0), o).starts_with("soa_s"));
    }
    o.burst_s.reset();
    CHECK(burst_duration_s(o = {}) == 0.07);
}

TEST_CASE("with fit and a given burst the SOA does not fall below it")
{
    plan_options o{.burst_s = 0.05, .timing = timing_kind::fit};
    const plan p = make_plan(palm, across(0.2), o);
    CHECK(*p.soa_s == doctest::Approx(0.2 / 3.0));
    CHECK(p.bursts.size() == 4);
    CHECK(p.bursts[0].duration_s == 0.05);
    o.burst_s = 0.07;
    CHECK(make_plan(palm, across(0.21), o).bursts[1].duration_s == doctest::Approx(0.07));
    const std::string why = refusal(palm, across(0.2), o);
    has(why, "shorter than the bursts of 0.07 s");
    has(why, "0.14 s or 0.21 s");
}

TEST_CASE("the other algorithms report that they do not use a burst's duration")
{
    plan_options o{.burst_s = 0.05};
    for (const auto method : {algorithm_kind::tactile_brush, algorithm_kind::continuous}) {
        o.algorithm = method;
        const plan with = make_plan(palm, across(1.0), o);
        CHECK(std::count_if(with.warnings.begin(), with.warnings.end(), [](const std::string& w) {
                  return w.find("0.05 s, is not used") != std::string::npos;
              }) == 1);
    }
}

TEST_CASE("bursts of less than one cycle of the carrier are warned about, for any reason")
{
    plan_options o;
    o.soa_s = 0.0483; // 3.125 ms by the law, a cycle at 320 Hz
    o.carrier_hz = 321.0;
    CHECK(make_plan(palm, across(1.0), o).warnings.empty());
    o.carrier_hz = 319.0;
    const plan p = make_plan(palm, across(1.0), o);
    REQUIRE(p.warnings.size() == 1);
    has(p.warnings[0], "21 of 21 bursts are shorter than one cycle of the carrier, 3.135 ms at 319 Hz");
    o = {};
    o.burst_s = 0.004; // one cycle at 250 Hz is enough
    CHECK(make_plan(palm, across(1.0), o).warnings.size() == 1);
    o.burst_s = 0.0039;
    CHECK(make_plan(palm, across(1.0), o).warnings.size() == 2);
    o = {};
    o.algorithm = algorithm_kind::tactile_brush;
    o.carrier_hz = 1.0;
    CHECK(make_plan(palm, across(1.0), o).warnings.size() >= 1);
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

    const plan p = make_plan(palm, across(1.0), {.soa_s = 0.06});
    CHECK(p.bursts.size() == 17);
    CHECK(p.bursts[3].duration_s == doctest::Approx((0.06 - 0.0473) / 0.32).epsilon(1e-12));
    CHECK(p.bursts[3].onset_s == doctest::Approx(0.18).epsilon(1e-12));
    CHECK(p.bursts[3].position.x_mm == doctest::Approx(7.2));
}

TEST_CASE("an SOA out of bounds is refused with both bounds")
{
    for (const double soa : {0.0473, 0.04, 0.0700001, 1.0, -1.0, 0.0, not_a_number, infinite}) {
        const std::string why = refusal(palm, across(1.0), {.soa_s = soa});
        CHECK(why.starts_with("soa_s: "));
        CHECK(why.find("0.0473") != std::string::npos);
        CHECK(why.find("0.07 ") != std::string::npos);
        CHECK_THROWS_AS(burst_duration_s({}, soa), error);
    }
    CHECK(burst_duration_s({}, 0.07) == 0.07);
    CHECK(burst_duration_s({}, 0.0537) == doctest::Approx(0.02));
}

TEST_CASE("fit: both ends of the path are sampled, with the fewest intervals")
{
    plan_options o{.timing = timing_kind::fit};
    generator g(21);
    for (int i = 0; i < rounds(2000); ++i) {
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
    for (int n = 1; n <= rounds(500); ++n) {
        const plan p = make_plan(palm, across(n * 0.07), o);
        REQUIRE(p.bursts.size() == static_cast<std::size_t>(n) + 1);
        REQUIRE(*p.soa_s == doctest::Approx(0.07).epsilon(1e-12));
    }
    CHECK(make_plan(palm, across(0.05), o).bursts.size() == 1);
    CHECK(make_plan(palm, across(0.05), o).soa_s == 0.07);
    o.soa_s = 0.0537; // the shortest burst allowed, but for the last digits
    for (const double duration : {1.074, 0.1074}) {
        const plan p = make_plan(palm, across(duration), o);
        CHECK(p.bursts.size() == static_cast<std::size_t>(std::lround(duration / 0.0537)) + 1);
        CHECK(p.bursts[0].duration_s == doctest::Approx(0.02));
    }
    o.soa_s = 0.05;
    CHECK(make_plan(palm, across(0.04), o).bursts.size() == 1); // nothing to fit
    CHECK_FALSE(refusal(palm, across(0.06), o).empty());
}

TEST_CASE("where fitted bursts would be too short the error names working durations on both sides")
{
    plan_options o{.timing = timing_kind::fit};
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
        const double below = number_after(why, "(use ");
        const double above = number_after(why, " s or ");
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
    plan_options o{.profile = {0.5, 0.03, 0.06}, .soa_s = 0.05};
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

TEST_CASE("intensity over time sets A_v; zero gives a burst without drives")
{
    const plan p = make_plan(palm, timed({{0.0, {0, 0}, 0.0}, {0.7, {40, 40}, 1.0}}));
    CHECK(p.bursts[0].drives.empty());
    CHECK(p.bursts[0].intensity == 0.0);
    CHECK(p.bursts[5].intensity == doctest::Approx(0.5));
    CHECK(energy(p.bursts[5].drives) == doctest::Approx(0.25));
}

} // namespace park_test
