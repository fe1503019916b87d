// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>

#include <tactor/error.hpp>
#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "strokes.hpp"

namespace make_plan_test {

using namespace tactor;
using namespace tactor::test;

namespace {

stroke across(double duration_s)
{
    return along("M 0 20 L 40 20", duration_s);
}

} // namespace

TEST_CASE("a path that leaves the array is refused at the place, or clamped")
{
    plan_options o;
    const stroke out = along("M 0 20 L 100 20", 1.0);
    for (const auto method :
         {algorithm_kind::park2016, algorithm_kind::tactile_brush, algorithm_kind::continuous}) {
        o.algorithm = method;
        o.outside = outside_kind::error;
        const std::string why = refusal(palm, out, o);
        CAPTURE(why);
        CHECK(why.find("leaves the array at (40.000, 20.000) mm after 0.4 s, and goes 60 mm outside") !=
              std::string::npos);
        CHECK(why.find("outside = clamp") != std::string::npos);
        const std::string start = refusal(palm, along("M -3 20 L 20 20", 1.0), o);
        CHECK(start.find("starts outside the array, at (-3.000, 20.000) mm, and goes 3 mm outside") !=
              std::string::npos);
        o.outside = outside_kind::clamp;
        CHECK_NOTHROW(make_plan(palm, out, o));
    }
    o.algorithm = algorithm_kind::park2016;
    const plan p = make_plan(palm, out, o);
    CHECK(p.bursts.back().position == point{40.0, 20.0});
    CHECK(p.bursts.back().drives == std::vector<drive>{{5, 1.0}});
}

TEST_CASE("a stroke's carrier wins over the common one; anything but a frequency is refused")
{
    stroke s = across(1.0);
    plan_options o;
    o.carrier_hz = 200.0;
    CHECK(make_plan(palm, s, o).carrier_hz == 200.0);
    s.sound.carrier_hz = 180.0;
    CHECK(make_plan(palm, s, o).carrier_hz == 180.0);
    s.sound.carrier_hz.reset();
    for (const double hz : {0.0, -250.0, not_a_number, infinite}) {
        o.carrier_hz = hz;
        CHECK(refusal(palm, s, o).starts_with("carrier_hz"));
    }
}

TEST_CASE("an absurd number of bursts is refused at once")
{
    plan_options o;
    o.profile = {0.32, 0.0, 0.07};
    o.soa_s = 1e-6;
    CHECK(refusal(palm, across(86400.0), o).find("bursts") != std::string::npos);
}

TEST_CASE("a scale defines half an intensity, and is held to its bounds")
{
    const intensity_scale linear;
    for (const double i : {0.0, 0.5, 1.0, 3.0, -1.0})
        CHECK(linear.amplitude(i) == i);
    for (const double exponent : {0.1, 0.6, 3.0}) {
        const intensity_scale s{scale_kind::stevens, exponent};
        CHECK(s.amplitude(0.0) == 0.0);
        CHECK(s.amplitude(1.0) == 1.0);
        CHECK(s.amplitude(0.5) == doctest::Approx(std::pow(0.5, 1.0 / exponent)));
    }
    for (const double db : {0.1, 7.0, 100.0}) {
        const intensity_scale s{.kind = scale_kind::sl, .sl_db = db};
        CHECK(s.amplitude(0.0) == 0.0);
        CHECK(s.amplitude(1.0) == 1.0);
        CHECK(s.amplitude(0.5) == doctest::Approx(std::pow(10.0, -0.5 * db / 20.0)));
    }
    for (intensity_scale s : {linear, intensity_scale{scale_kind::stevens, 0.6},
                              intensity_scale{.kind = scale_kind::sl, .sl_db = 7.0}}) {
        const double plain = s.amplitude(0.5);
        s.level_db = -9.0;
        CHECK(s.amplitude(0.5) == doctest::Approx(plain * std::pow(10.0, -9.0 / 20.0)).epsilon(1e-14));
        CHECK(s.amplitude(0.0) == 0.0);
        s.level_db = not_a_number;
        CHECK_THROWS_AS(static_cast<void>(s.amplitude(0.5)), error);
    }
    for (const double exponent : {0.09, 3.01, not_a_number})
        CHECK_THROWS_AS(static_cast<void>(intensity_scale{scale_kind::stevens, exponent}.amplitude(0.5)),
                        error);
    for (const double db : {0.0, 100.1, not_a_number})
        CHECK_THROWS_AS(
            static_cast<void>(intensity_scale{.kind = scale_kind::sl, .sl_db = db}.amplitude(0.5)), error);
}

TEST_CASE("a custom model is used by its name, and held to its contract")
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
    CHECK_FALSE(refusal(palm, across(1.0), with({{3, not_a_number}})).empty());
    CHECK_FALSE(refusal(palm, across(1.0), with({{3, 0.0}})).empty());
}

TEST_CASE("a layout of another array is refused")
{
    CHECK_THROWS_AS(make_plan(palm, layout(preset_array("palm-2x4")), across(1.0), {}), error);
}

TEST_CASE("a continuous plan has no bursts, and the phantom at every time")
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
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
    REQUIRE(p.curve);
    burst b;
    b.tau_s = 3.0;
    p.curve->at(0.25, b);
    CHECK(b.onset_s == 0.25);
    CHECK(b.duration_s == 0.0);
    CHECK_FALSE(b.tau_s);
    CHECK(b.position.x_mm == doctest::Approx(10.0));
    CHECK(b.intensity == doctest::Approx(0.875));
    REQUIRE(b.drives.size() == 2);
    CHECK(b.drives[0].tactor == 3);
    CHECK(b.drives[0].amplitude == doctest::Approx(0.875 * std::sqrt(0.5)));
    p.curve->at(99.0, b);
    CHECK(b.drives.size() == 1);
    CHECK(b.onset_s == 1.0);
    p.curve->at(-1.0, b);
    CHECK(b.position == point{0.0, 20.0});
}

TEST_CASE("a continuous plan finds a short way out between two bursts")
{
    plan_options o;
    const stroke s = timed({{0.0, {30, 20}}, {0.03, {50, 20}}, {0.06, {30, 20}}, {1.0, {20, 20}}});
    CHECK(refusal(palm, s, o).empty());
    o.algorithm = algorithm_kind::continuous;
    CHECK(refusal(palm, s, o).find("(40.000, 20.000) mm after 0.015 s") != std::string::npos);
}

} // namespace make_plan_test
