// SPDX-License-Identifier: MIT
// Fitting of any stroke to any array: as large as possible, in shape, and nowhere outside.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "caught.hpp"
#include "rounds.hpp"
#include "strokes.hpp"

namespace fit_test {

using namespace tactor;
using namespace tactor::test;

namespace {

const layout low(preset_array("palm-2x4"));

std::string complaint(const std::vector<stroke>& s, const layout& l, double margin_mm = 0.0)
{
    return caught_message([&] { return fit_strokes(s, l, margin_mm); });
}

/// Places at equal times: the fitted stroke is at the mapped places; returns the least distance to the edge.
void check_places(const stroke& drawn, const stroke& now, const fitting& f, const layout& l)
{
    for (int k = 0; k <= 200; ++k) {
        const double part = k / 200.0;
        const point p = now.motion.position(part * now.motion.duration_s());
        CHECK(l.contains(p));
        if (!f.line)
            CHECK(distance_mm(p, f(drawn.motion.position(part * drawn.motion.duration_s()))) < 2e-6);
    }
}

plan_options strictly(algorithm_kind a)
{
    plan_options o{.algorithm = a, .outside = outside_kind::error};
    return o;
}

std::string drawing(generator& g)
{
    const auto n = [&] { return std::to_string(between(g, -300.0, 300.0)) + " "; };
    switch (pick(g, 0, 3)) {
    case 0:
        return "M " + n() + n() + "L " + n() + n();
    case 1:
        return "M " + n() + n() + "C " + n() + n() + n() + n() + n() + n() + "S " + n() + n() + n() + n();
    case 2:
        return "M " + n() + n() + "A " + n() + n() + n() + "1 0 " + n() + n();
    default:
        return "M " + n() + n() + "L " + n() + n() + "Q " + n() + n() + n() + n() + "Z";
    }
}

} // namespace

TEST_CASE("a circle of the paper fits palm-2x4: as high as the array, in its middle, round, in its time")
{
    const stroke circle = make_stroke(trajectory::along(path::arc({20, 20}, 16, 0, 360), 2.8));
    CHECK_FALSE(refusal(preset_array("palm-2x4"), circle, {}).empty());
    const fitted_strokes r = fit_strokes({circle}, low);
    CHECK(r.placed.scale == doctest::Approx(20.0 / 32.0).epsilon(1e-12));
    CHECK(distance_mm(r.placed.from, {20, 20}) < 1e-9);
    CHECK(distance_mm(r.placed.to, {30, 10}) < 1e-9);
    CHECK_FALSE(r.placed.line);
    const trajectory& now = r.strokes.front().motion;
    CHECK(now.duration_s() == 2.8);
    CHECK(now.length_mm() == doctest::Approx(20.0 * std::numbers::pi).epsilon(1e-9));
    for (int k = 0; k < 100; ++k)
        CHECK(distance_mm(now.position(0.028 * k), {30, 10}) == doctest::Approx(10.0).epsilon(1e-9));
    CHECK(refusal(preset_array("palm-2x4"), r.strokes.front(), {}).empty());
}

TEST_CASE("a margin is kept from every edge, and must leave space")
{
    const stroke square = along("M 0 0 H 1 V 1 H 0 Z", 1.0);
    const fitted_strokes r = fit_strokes({square}, low, 4.0);
    CHECK(r.placed.scale == doctest::Approx(12.0).epsilon(1e-12));
    CHECK(r.placed.margin_mm == 4.0);
    const layout diamond(make_array({{0, -10}, {10, 0}, {0, 10}, {-10, 0}}));
    for (const stroke& s : fit_strokes({square}, diamond, 2.0).strokes)
        for (double t = 0.0; t < 1.0; t += 0.01) {
            const point p = s.motion.position(t);
            CHECK((10.0 - std::abs(p.x_mm) - std::abs(p.y_mm)) / std::numbers::sqrt2 > 2.0 - 1e-9);
        }
    CHECK(complaint({square}, low, 10.0) ==
          "margin_mm: 10 mm on each side leaves no space in the array (use less than 10 mm)");
    CHECK(complaint({square}, low, -1.0) == "margin_mm: -1 mm (give 0 mm or more)");
    CHECK(complaint({square}, low, not_a_number).starts_with("margin_mm: nan mm"));
    CHECK(complaint({square}, low, infinite).starts_with("margin_mm: inf mm"));
}

TEST_CASE("several strokes are fitted together")
{
    const stroke left = along("M 0 0 V 100", 1.0);
    stroke right = along("M 300 0 V 100", 1.0);
    right.start_s = 3.0;
    right.sound.carrier_hz = 200.0;
    const fitted_strokes r = fit_strokes({left, right}, low);
    CHECK(r.placed.scale == doctest::Approx(0.2).epsilon(1e-12));
    CHECK(distance_mm(r.strokes[0].motion.position(0.0), {0, 0}) < 1e-9);
    CHECK(distance_mm(r.strokes[1].motion.position(1.0), {60, 20}) < 1e-9);
    CHECK(r.strokes[1].start_s == 3.0);
    CHECK(r.strokes[1].sound.carrier_hz == 200.0);
    CHECK(fit_strokes({}, low).strokes.empty());
}

TEST_CASE("a stroke with a speed keeps it, one with a time keeps that")
{
    stroke s = along("M 0 0 H 600", 10.0);
    CHECK(fit_strokes({s}, low).strokes[0].motion.duration_s() == 10.0);
    s.speed_mm_s = 60.0;
    CHECK(fit_strokes({s}, low).strokes[0].motion.duration_s() == doctest::Approx(1.0).epsilon(1e-12));
    const auto file = [](const std::string& more) {
        const auto read = parse_strokes_toml("[stroke]\npath = \"M 0 0 H 600\"\n" + more, "a.toml");
        return fit_strokes(read, low).strokes[0].motion.duration_s();
    };
    CHECK(file("") == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(file("speed_mm_s = 30") == doctest::Approx(2.0).epsilon(1e-12));
    CHECK(file("duration_s = 5") == 5.0);
    const auto drawn = [](const std::string& more) {
        const auto read = parse_strokes_svg(
            "<svg xmlns='http://www.w3.org/2000/svg'><path d='M 0 0 H 600' " + more + "/></svg>", "a.svg");
        return fit_strokes(read, low).strokes[0].motion.duration_s();
    };
    CHECK(drawn("") == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(drawn("data-speed-mm-s='30'") == doctest::Approx(2.0).epsilon(1e-12));
    CHECK(drawn("data-duration-s='5'") == 5.0);
}

TEST_CASE("timed points keep their times, intensities and factor")
{
    stroke s = timed({{0.0, {0, 0}, 0.5}, {1.0, {600, 0}, 1.0}, {3.0, {600, 200}, 0.2}});
    s.motion = s.motion.with_duration(6.0).with_intensity(0.5);
    const trajectory now = fit_strokes({s}, low).strokes[0].motion;
    CHECK(now.duration_s() == 6.0);
    CHECK(distance_mm(now.position(0.0), {0, 0}) < 1e-9);
    CHECK(distance_mm(now.position(2.0), {60, 0}) < 1e-9);
    CHECK(distance_mm(now.position(6.0), {60, 20}) < 1e-9);
    CHECK(now.intensity(2.0) == doctest::Approx(0.5));
}

TEST_CASE("strokes without extent, or with one only, are fitted")
{
    const stroke resting = timed({{0.0, {7, 7}, 1.0}, {1.0, {7, 7}, 1.0}});
    const fitted_strokes r = fit_strokes({resting}, low);
    CHECK(r.placed.scale == 1.0);
    CHECK(distance_mm(r.strokes[0].motion.position(0.5), {30, 10}) < 1e-9);
    const layout one(make_array({{3, 4}}));
    CHECK(distance_mm(fit_strokes({resting}, one).strokes[0].motion.position(0.5), {3, 4}) < 1e-9);
    CHECK(complaint({along("M 0 0 L 1 1", 1.0)}, one)
              .starts_with("stroke: it does not fit on a single tactor"));
    CHECK(complaint({resting}, one, 1.0).starts_with("margin_mm: 1 mm on each side"));

    CHECK(fit_strokes({along("M 5 5 H 6", 1.0)}, low).placed.scale == doctest::Approx(60.0));
    CHECK(fit_strokes({along("M 5 5 V 7", 1.0)}, low).placed.scale == doctest::Approx(10.0));
    CHECK(fit_strokes({along("M 0 0 L 1 1", 1.0)}, low).placed.scale == doctest::Approx(20.0));
}

TEST_CASE("an array in one row takes strokes along it")
{
    const array row = make_array({{0, 5}, {40, 5}, {80, 5}, {120, 5}});
    const layout l(row);
    const stroke circle = make_stroke(trajectory::along(path::arc({0, 0}, 1, 180, 360), 2.0));
    const fitted_strokes r = fit_strokes({circle}, l, 10.0);
    CHECK(r.placed.line);
    CHECK(r.placed.scale == doctest::Approx(50.0).epsilon(1e-12));
    const trajectory& now = r.strokes[0].motion;
    CHECK(now.length_mm() == doctest::Approx(200.0).epsilon(1e-9));
    CHECK(distance_mm(now.position(0.0), {10, 5}) < 1e-9); // there and back at one speed
    CHECK(distance_mm(now.position(0.5), {60, 5}) < 1e-9);
    CHECK(distance_mm(now.position(1.0), {110, 5}) < 1e-9);
    CHECK(refusal(row, r.strokes[0], {}).empty());
    CHECK(refusal(row, r.strokes[0], strictly(algorithm_kind::continuous)).empty());
    CHECK(complaint({along("M 0 0 V 9", 1.0)}, l)
              .starts_with("stroke: it only goes across the line of tactors"));
    stroke across = along("M 3 0 V 9", 1.0);
    CHECK(complaint({circle, across}, l).starts_with("stroke 1: it only goes across the line of tactors"));
    across.name = "left";
    CHECK(complaint({circle, across}, l)
              .starts_with("stroke \"left\": it only goes across the line of tactors"));
    CHECK(complaint({circle, along("M 3 0 L 3.1 9", 1.0)}, l).empty());
    CHECK(complaint({along("M 0 0 H 9", 1.0)}, l, 60.0).find("(use less than 60 mm)") != std::string::npos);

    // Measured places are never in line: a wave must not become as thin as their errors.
    const layout measured(make_array({{0, 0.2}, {40, -0.3}, {80, 0.1}, {120, 0.0}}));
    CHECK(fit_strokes({circle}, measured).placed.scale > 59.0);
    CHECK(l.contains(fit_strokes({circle}, measured).placed.to) == false);
    check_places(circle, fit_strokes({circle}, measured).strokes[0], fit_strokes({circle}, measured).placed,
                 measured);
}

TEST_CASE("strokes ask for a fit alone, or together")
{
    const layout l(preset_array("palm-3x3"));
    std::vector<stroke> asked{along("M 0 0 L 10 0", 1.0), along("M 3 3 L 4 3", 1.0),
                              along("M 0 10 L 10 10", 1.0), along("M 0 0 L 1 0", 1.0),
                              along("M 7 7 L 9 7", 1.0)};
    asked[0].fit = asked[2].fit = stroke_fit{5.0, 3};
    asked[3].fit = asked[4].fit = stroke_fit{};
    const std::vector<stroke> s = apply_fits(asked, l);
    const auto goes = [&](std::size_t i, point from, point to) {
        return distance_mm(s[i].motion.position(0.0), from) < 1e-9 &&
               distance_mm(s[i].motion.position(1.0), to) < 1e-9;
    };
    CHECK(goes(0, {5, 5}, {35, 5}));
    CHECK(goes(2, {5, 35}, {35, 35}));
    CHECK(goes(1, {3, 3}, {4, 3})); // without a fit
    CHECK(goes(3, {0, 20}, {40, 20}));
    CHECK(goes(4, {0, 20}, {40, 20}));
    for (const stroke& k : s)
        CHECK_FALSE(k.fit);
}

TEST_CASE("any fitted picture is accepted with outside = error, and no larger one would be")
{
    generator g(22);
    for (int k = 0; k < rounds(300); ++k) {
        const unsigned kind = k % kinds_of_array;
        const array a = rotated(some_array(g, kind), between(g, 0.0, 6.3));
        const layout l(a);
        std::vector<stroke> drawn;
        for (unsigned n = pick(g, 1, 3); n > 0; --n)
            drawn.push_back(along(drawing(g), 1.4));
        CAPTURE(k);
        if (a.tactors.size() == 1) {
            CHECK(complaint(drawn, l).starts_with("stroke: it does not fit on a single tactor"));
            continue;
        }
        const fitted_strokes r = fit_strokes(drawn, l);
        REQUIRE(r.strokes.size() == drawn.size());
        double nearest = infinite;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            CHECK(refusal(a, r.strokes[i], strictly(algorithm_kind::park2016)).empty());
            CHECK(refusal(a, r.strokes[i], strictly(algorithm_kind::continuous)).empty());
            check_places(drawn[i], r.strokes[i], r.placed, l);
            // A little larger round the middle, it would leave.
            for (int at = 0; at <= 4000; ++at) {
                const point p = r.strokes[i].motion.position(1.4 * at / 4000.0);
                const point more{r.placed.to.x_mm + 1.003 * (p.x_mm - r.placed.to.x_mm),
                                 r.placed.to.y_mm + 1.003 * (p.y_mm - r.placed.to.y_mm)};
                nearest = std::min(nearest, l.contains(more) ? infinite : 0.0);
            }
        }
        CHECK(nearest == 0.0);
    }
}

} // namespace fit_test
