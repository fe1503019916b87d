// SPDX-License-Identifier: MIT
// Plans of targets that ease, change their speed and rest.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <tactor/phantom.hpp>

#include "strokes.hpp"

namespace moving_test {

using namespace tactor;
using namespace tactor::test;

namespace {

stroke moving(std::string_view svg, const movement& m)
{
    return make_stroke(trajectory::along(path::from_svg(svg), m));
}

double minimum_jerk(double u)
{
    return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
}

const movement jerk{.duration_s = 2.1, .easing = easing_kind::minimum_jerk};
const movement resting{.duration_s = 3.0,
                       .easing = easing_kind::in_out,
                       .speed_mm_s = {{0.0, 1.0}, {1.0, 2.0}},
                       .intensity = {{0.0, 0.2}, {1.0, 0.8}},
                       .rests = {{0.4, 0.6, 0.0}}};

} // namespace

TEST_CASE("bursts of park2016 are at the eased target's place at their onset, with its strength")
{
    const plan p = make_plan(palm, moving("M 0 10 L 40 30", jerk), {});
    REQUIRE(p.bursts.size() == 31);
    for (const burst& b : p.bursts)
        CHECK(std::abs(b.position.x_mm - 40.0 * minimum_jerk(b.onset_s / 2.1)) < 1e-9);
    const stroke s = moving("M 0 10 L 40 30", resting);
    const plan q = make_plan(palm, s, {});
    unsigned silent = 0;
    for (const burst& b : q.bursts) {
        CHECK(b.intensity == s.motion.intensity(b.onset_s));
        silent += b.drives.empty() ? 1 : 0;
    }
    CHECK(silent >= 8); // 0.6 s of rest in silence
    CHECK(silent <= 9);
}

TEST_CASE("the Tactile Brush times its places by the eased target's arrival")
{
    for (const movement& m : {jerk, resting}) {
        const stroke s = moving("M 0 0 H 45", m);
        const plan p = make_plan(arm, s, brush());
        REQUIRE(p.bursts.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(p.bursts[i].position == point{15.0 * static_cast<double>(i), 0.0});
            CHECK(std::abs(s.motion.position(*p.bursts[i].tau_s).x_mm - p.bursts[i].position.x_mm) < 1e-9);
        }
    }
    const plan p = make_plan(arm, moving("M 0 0 H 45", jerk), brush());
    CHECK(std::abs(minimum_jerk(*p.bursts[1].tau_s / 2.1) - 1.0 / 3.0) < 1e-12);
}

TEST_CASE("the shortest duration that the Tactile Brush names works for eased targets with rests")
{
    stroke s = moving("M 0 0 H 45", resting);
    s.motion = s.motion.with_duration(0.1);
    const double shortest = number_after(refusal(arm, s, brush()), "the shortest duration that works is ");
    REQUIRE(shortest > 0.1);
    s.motion = s.motion.with_duration(shortest);
    CHECK(refusal(arm, s, brush()).empty());
    s.motion = s.motion.with_duration(shortest * 0.999);
    CHECK_FALSE(refusal(arm, s, brush()).empty());
}

TEST_CASE("continuous reports where and when an eased target leaves the array")
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    const std::string why = refusal(palm, moving("M 0 10 C 20 10 60 20 60 30", jerk), o);
    CHECK(why.find("leaves the array at (40.000, ") != std::string::npos);
    const double when = number_after(why, "mm after ");
    CHECK(std::abs(moving("M 0 10 C 20 10 60 20 60 30", jerk).motion.position(when).x_mm - 40.0) < 0.1);
}

TEST_CASE("a path that is short compared with the tactors' distance is warned of")
{
    const auto warned = [](std::string_view svg) {
        for (const std::string& w : make_plan(palm, along(svg, 1.0)).warnings)
            if (w.find("may not be felt to move") != std::string::npos)
                return w;
        return std::string();
    };
    CHECK(warned("M 10 10 h 3.9") == "its path of 3.9 mm is shorter than a fifth of the 20 mm between "
                                     "tactors: it may not be felt to move");
    CHECK(warned("M 10 10 h 4").empty());
    CHECK(make_plan(palm, timed({{0.0, {10.0, 10.0}}, {1.0, {10.0, 10.0}}})).warnings.empty());
}

TEST_CASE("a stroke's choice wins over the common one")
{
    stroke s = along("M 0 10 L 40 30", 1.4);
    s.choices = {{}, phantom_kind::barycentric, 0.06, 0.05};
    const plan p = make_plan(palm, s, {.phantom = phantom_kind::gaussian});
    CHECK(p.phantom == "barycentric");
    CHECK(p.soa_s == 0.06);
    CHECK(p.bursts[0].duration_s == 0.05);
    s.choices.algorithm = algorithm_kind::continuous;
    CHECK(make_plan(palm, s).curve.has_value());
    s.choices.soa_s = 0.02;
    s.choices.algorithm.reset();
    CHECK(refusal(palm, s, {}).find("burst_s: ") == 0);
}

TEST_CASE("a stroke's impossible SOA or burst is refused with its place")
{
    const auto told = [](const char* text, plan_options o = {}) {
        const stroke s = parse_strokes_toml(text, "w.toml").front();
        try {
            static_cast<void>(make_plan(palm, s, o));
        } catch (const error& e) {
            return std::pair<std::string, unsigned>{e.what(), e.place().line};
        }
        return std::pair<std::string, unsigned>{};
    };
    using is = std::pair<std::string, unsigned>;
    const char* soa = "[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 9\n";
    CHECK(told(soa) == is{"w.toml:3:9: soa_s: 9 s is out of bounds: an SOA is longer than 0.0473 s and at "
                          "most 0.07 s (use 0.07)",
                          3});
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nburst_s = 0.2\n") ==
          is{"w.toml:3:11: burst_s: 0.2 s is longer than the SOA of 0.07 s, and bursts must not "
             "overlap (use at most 0.07 s, or a longer SOA)",
             3});
    // The stroke's SOA is too short for the common duration.
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 0.05\n", {.burst_s = 0.06}).second == 3);
    // The common value is not the file's fault.
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nburst_s = 0.02\n", {.soa_s = 90.0}).first.find("soa_s: ") ==
          0);
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 0.05\nburst_s = 0.05\n").second == 0);
}

TEST_CASE("a stroke that asks for a fit is fitted")
{
    stroke s = along("M 100 100 L 900 700", 1.4);
    s.fit = stroke_fit{2.0};
    const plan p = make_plan(palm, s);
    CHECK(p.bursts.front().position.x_mm == doctest::Approx(2.0));
    CHECK(p.bursts.back().position.x_mm == doctest::Approx(38.0));
    const std::vector<stroke> both = apply_fits({s, along("M 0 0 H 10", 1.0)}, layout(palm));
    CHECK_FALSE(both[0].fit);
    CHECK(both[1].motion.length_mm() == 10.0);
    CHECK(make_plan(palm, both[0]) == p);
}

} // namespace moving_test
