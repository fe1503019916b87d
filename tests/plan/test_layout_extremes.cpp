// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "core/access.hpp"
#include "oracle.hpp"
#include "plan/faces/layout_impl.hpp"
#include "rounds.hpp"

namespace layout_extremes_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("tactors in one line have no faces; the hull is the line")
{
    generator g(14);
    for (unsigned round = 0; round < 300; ++round) {
        const array a = line(g, pick(g, 2, 12));
        const layout l(a);
        REQUIRE(l.faces().empty());
        const point first = a.tactors.front().position;
        const point last = a.tactors.back().position;
        const double u = between(g, 0.0, 1.0);
        const point on{first.x_mm + u * (last.x_mm - first.x_mm), first.y_mm + u * (last.y_mm - first.y_mm)};
        REQUIRE(l.contains(on));
        const point off{on.x_mm - (last.y_mm - first.y_mm) * 0.1, on.y_mm + (last.x_mm - first.x_mm) * 0.1};
        REQUIRE_FALSE(l.contains(off));
        REQUIRE(distance_mm(l.nearest(off), on) < 1e-9);
    }
    const layout one(make_array({{3.0, 4.0}}));
    CHECK(one.faces().empty());
    CHECK(one.pitch_mm() == 0.0);
    CHECK(one.contains({3.0, 4.0}));
    CHECK_FALSE(one.contains({3.0, 4.1}));
    CHECK(one.nearest({9.0, 9.0}) == point{3.0, 4.0});
}

TEST_CASE("nearly collinear and crowded tactors: every point of the hull is played")
{
    generator g(16);
    for (unsigned round = 0; round < 1500; ++round) {
        const double scale = std::pow(10.0, between(g, -8.0, 1.0));
        std::vector<point> p;
        for (unsigned i = 0; i < pick(g, 3, 12); ++i)
            p.push_back({10.0 * i + between(g, 0.0, 3.0), between(g, -scale, scale)});
        if (round % 3 == 0)
            p.push_back({50.0, 60.0});
        const layout l(rotated(make_array(p), between(g, 0.0, 6.3)));
        const auto model = make_phantom(phantom_kind::inverse_distance, l);
        const auto centroid = make_phantom(phantom_kind::barycentric, l);
        std::vector<drive> d;
        for (unsigned i = 0; i < 20; ++i) {
            const point q = some_point(g, l);
            CAPTURE(round);
            REQUIRE(l.contains(q));
            model->weights(q, 1.0, d);
            REQUIRE(energy(d) == doctest::Approx(1.0).epsilon(1e-12));
            REQUIRE(d.size() <= 3);
            centroid->weights(q, 1.0, d);
            REQUIRE(energy(d) == doctest::Approx(1.0).epsilon(1e-12));
            REQUIRE(distance_mm(energy_centroid(l, d), q) < 1e-5);
        }
    }
}

TEST_CASE("tactors a micrometre apart beside others far away")
{
    const layout l(
        make_array({{0.0, 0.0}, {1e-3, 0.0}, {0.0, 1e-3}, {500.0, 0.0}, {0.0, 500.0}, {500.0, 500.0}}));
    std::vector<drive> d;
    make_phantom(phantom_kind::inverse_distance, l)->weights({0.4e-3, 0.3e-3}, 1.0, d);
    CHECK(energy(d) == doctest::Approx(1.0));
    CHECK(d.size() == 3);
    CHECK_THROWS_WITH_AS(layout(make_array({{0.0, 0.0}, {2e-6, 0.0}, {0.0, 2e-6}, {1e6, 0.0}, {0.0, 1e6}})),
                         doctest::Contains("too near"), error);
}

TEST_CASE("pitch is the median distance to the nearest neighbour")
{
    CHECK(layout(preset_array("palm-3x3")).pitch_mm() == doctest::Approx(20.0));
    CHECK(layout(make_grid("g", 3, 3, 20.0, 40.0)).pitch_mm() == doctest::Approx(20.0));
    CHECK(layout(make_array({{0, 0}, {1, 0}, {10, 0}, {30, 0}})).pitch_mm() == doctest::Approx(5.0));
}

TEST_CASE("impossible arrays are refused")
{
    CHECK_THROWS_AS(layout(make_array({})), error);
    CHECK_THROWS_AS(layout(make_array({{0, 0}, {not_a_number, 1}})), error);
    CHECK_THROWS_AS(layout(make_array({{0, 0}, {0, 0}})), error);
    CHECK_THROWS_AS(layout(make_array({{0, 0}, {1e300, 0}})), error);
}

TEST_CASE("a ring of 1000 tactors, one face, is played by the rules")
{
    const array a = make_ring(1000, 50.0, false);
    const layout l(a);
    REQUIRE(l.faces().size() == 1);
    const auto model = make_phantom(phantom_kind::inverse_distance, l);
    generator g(18);
    std::vector<drive> d;
    for (int i = 0; i < rounds(500); ++i) {
        const double r = between(g, 0.0, 49.9);
        const double angle = between(g, 0.0, 6.3);
        const point p = i == 0 ? point{0.0, 0.0} : point{r * std::cos(angle), r * std::sin(angle)};
        model->weights(p, 1.0, d);
        REQUIRE(energy(d) == doctest::Approx(1.0).epsilon(1e-12));
        if (d.size() == 3)
            REQUIRE(
                in_triangle(l.places()[d[0].tactor], l.places()[d[1].tactor], l.places()[d[2].tactor], p));
    }
}

} // namespace layout_extremes_test
