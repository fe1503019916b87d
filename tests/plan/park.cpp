// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>

#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "strokes.hpp"

using namespace tactor;
using namespace tactor::test;

namespace {

const array palm = preset_array("palm-3x3");

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
    for (const double soa : {0.0473, 0.04, 0.0700001, 1.0, -1.0, 0.0, double(NAN), double(INFINITY)}) {
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
    CHECK(make_plan(palm, across(1.4), o).bursts.size() == 21);
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
    o.min_duration_s = NAN;
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
                                     {NAN, 0.0473, 0.07},
                                     {0.32, -0.1, 0.07},
                                     {0.32, NAN, 0.07},
                                     {0.32, 0.0473, 0.0473},
                                     {0.32, 0.0473, INFINITY}}) {
        o.profile = bad;
        CHECK_FALSE(refusal(palm, across(1.0), o).empty());
    }
}

TEST_CASE("a path that leaves the array is refused where it does, or clamped")
{
    plan_options o;
    const stroke out = along("M 0 20 L 100 20", 1.0);
    for (const auto method : {algorithm::park2016, algorithm::tactile_brush, algorithm::continuous}) {
        o.method = method;
        o.leave = outside::error;
        const std::string why = refusal(palm, out, o);
        CAPTURE(why);
        CHECK(why.find("leaves the array at (40.000, 20.000) mm after 0.4 s") != std::string::npos);
        CHECK(why.find("--outside clamp") != std::string::npos);
        const std::string start = refusal(palm, along("M -3 20 L 20 20", 1.0), o);
        CHECK(start.find("starts outside the array, at (-3.000, 20.000) mm") != std::string::npos);
        o.leave = outside::clamp;
        CHECK_NOTHROW(make_plan(palm, out, o));
    }
    o.method = algorithm::park2016;
    const plan p = make_plan(palm, out, o);
    CHECK(p.bursts.back().position == point{40.0, 20.0});
    CHECK(p.bursts.back().drives == std::vector<drive>{{5, 1.0}});
}

TEST_CASE("intensity over time sets A_v; none gives a burst without drives")
{
    const plan p = make_plan(palm, timed({{0.0, {0, 0}, 0.0}, {0.7, {40, 40}, 1.0}}));
    CHECK(p.bursts[0].drives.empty());
    CHECK(p.bursts[0].intensity == 0.0);
    CHECK(p.bursts[5].intensity == doctest::Approx(0.5));
    CHECK(energy(p.bursts[5].drives) == doctest::Approx(0.25));
}

TEST_CASE("carrier: the stroke's own before the common one; anything but a frequency is refused")
{
    stroke s = across(1.0);
    plan_options o;
    o.carrier_hz = 200.0;
    CHECK(make_plan(palm, s, o).carrier_hz == 200.0);
    s.carrier_hz = 180.0;
    CHECK(make_plan(palm, s, o).carrier_hz == 180.0);
    s.carrier_hz.reset();
    for (const double hz : {0.0, -250.0, double(NAN), double(INFINITY)}) {
        o.carrier_hz = hz;
        CHECK(refusal(palm, s, o).starts_with("--carrier"));
    }
}

TEST_CASE("more bursts than anyone can mean are refused at once")
{
    plan_options o;
    o.profile = {0.32, 0.0, 0.07};
    o.soa_s = 1e-6;
    CHECK(refusal(palm, across(86400.0), o).find("bursts") != std::string::npos);
}

TEST_CASE("a model of one's own is used by its name, and held to its contract")
{
    struct nearest final : phantom_model {
        std::vector<drive> answer;
        std::string_view name() const noexcept override { return "mine"; }
        void weights(point, double a_v, std::vector<drive>& out) const override
        {
            out = answer;
            for (drive& d : out)
                d.amplitude *= a_v;
        }
    };
    const auto with = [&](std::vector<drive> answer) {
        auto m = std::make_shared<nearest>();
        m->answer = std::move(answer);
        plan_options o;
        o.custom_phantom = m;
        return o;
    };
    const plan p = make_plan(palm, across(1.0), with({{2, 0.5}, {7, 0.25}}));
    CHECK(p.phantom == "mine");
    CHECK(p.bursts[4].drives == std::vector<drive>{{2, 0.5}, {7, 0.25}});
    CHECK_FALSE(refusal(palm, across(1.0), with({{9, 1.0}})).empty());
    CHECK_FALSE(refusal(palm, across(1.0), with({{3, 1.0}, {2, 1.0}})).empty());
    CHECK_FALSE(refusal(palm, across(1.0), with({{3, NAN}})).empty());
    CHECK_FALSE(refusal(palm, across(1.0), with({{3, 0.0}})).empty());
}

TEST_CASE("a layout of another array is refused")
{
    CHECK_THROWS_AS(make_plan(palm, layout(preset_array("palm-2x4")), across(1.0), {}), error);
}

TEST_CASE("continuous: no bursts, the phantom at every time")
{
    plan_options o;
    o.method = algorithm::continuous;
    o.phantom = phantom_kind::barycentric;
    plan p;
    {
        const array a = palm;
        p = make_plan(a, timed({{0.0, {0, 20}, 1.0}, {1.0, {40, 20}, 0.5}}), o);
    }
    CHECK(p.algorithm == "continuous");
    CHECK(p.phantom == "barycentric");
    CHECK(p.bursts.empty());
    CHECK_FALSE(p.soa_s);
    CHECK(p.total_s == 1.0);
    REQUIRE(p.at);
    burst b;
    b.tau_s = 3.0;
    p.at(0.25, b);
    CHECK(b.onset_s == 0.25);
    CHECK(b.duration_s == 0.0);
    CHECK_FALSE(b.tau_s);
    CHECK(b.position.x_mm == doctest::Approx(10.0));
    CHECK(b.intensity == doctest::Approx(0.875));
    REQUIRE(b.drives.size() == 2);
    CHECK(b.drives[0].tactor == 3);
    CHECK(b.drives[0].amplitude == doctest::Approx(0.875 * std::sqrt(0.5)));
    p.at(99.0, b);
    CHECK(b.drives.size() == 1);
    CHECK(b.onset_s == 1.0);
    p.at(-1.0, b);
    CHECK(b.position == point{0.0, 20.0});
}

TEST_CASE("continuous: a short way out between two bursts is found")
{
    plan_options o;
    const stroke s = timed({{0.0, {30, 20}}, {0.03, {50, 20}}, {0.06, {30, 20}}, {1.0, {20, 20}}});
    CHECK(refusal(palm, s, o).empty());
    o.method = algorithm::continuous;
    CHECK(refusal(palm, s, o).find("(40.000, 20.000) mm after 0.015 s") != std::string::npos);
}
