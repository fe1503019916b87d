// SPDX-License-Identifier: MIT
// Arcs of path data, by closed forms, and the implied handles of the other commands.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>

#include "caught.hpp"

namespace path_arcs_test {

using tactor::path;
using tactor::point;

namespace {

const double pi = std::numbers::pi;

void check_at(const path& p, double share, point want, double within)
{
    const point got = p.at(share * p.length_mm());
    CAPTURE(p.svg());
    CAPTURE(got.x_mm);
    CAPTURE(got.y_mm);
    CHECK(tactor::distance_mm(got, want) <= within);
}

} // namespace

TEST_CASE("arcs in path data are circles")
{
    for (const char* data :
         {"M 20 4 A 16 16 0 0 0 20 36", "m20 4a16 16 0 0 0 0 32", "M20,4A16,16,0,0020,36"}) {
        const path p = path::from_svg(data);
        CHECK(p.length_mm() == doctest::Approx(16.0 * pi).epsilon(1e-14));
        check_at(p, 0.5, {4.0, 20.0}, 1e-12);
    }
    const path three_quarters = path::from_svg("M 20 36 A 16 16 0 1 1 36 20");
    CHECK(three_quarters.length_mm() == doctest::Approx(24.0 * pi).epsilon(1e-14));
    check_at(three_quarters, 1.0 / 3.0, {4.0, 20.0}, 1e-12);
    check_at(three_quarters, 2.0 / 3.0, {20.0, 4.0}, 1e-12);
}

TEST_CASE("a half circle is one anywhere, though its ends are rounded")
{
    for (int k = 1; k <= 500; ++k) {
        const double x = 0.1 * k;
        const path p = path::from_svg(fmt::format("M {} {} a 3.3 3.3 0 0 1 6.6 0", x, 0.7 * x));
        CHECK(p.length_mm() == doctest::Approx(3.3 * pi).epsilon(1e-13));
        check_at(p, 0.5, {x + 3.3, 0.7 * x - 3.3}, 1e-12);
    }
}

TEST_CASE("the two flags choose one of four arcs")
{
    struct sample {
        const char* flags;
        double turns;
        point middle;
    };
    const double r = 10.0;
    const double h = r * std::sqrt(0.5);
    const sample samples[] = {{"0 0", 0.25, {h, h}},
                              {"0 1", 0.25, {r - h, r - h}},
                              {"1 0", 0.75, {r + h, r + h}},
                              {"1 1", 0.75, {-h, -h}}};
    for (const sample& s : samples) {
        const path p = path::from_svg(fmt::format("M 0 10 A 10 10 0 {} 10 0", s.flags));
        CHECK(p.length_mm() == doctest::Approx(2.0 * pi * r * s.turns).epsilon(1e-14));
        check_at(p, 0.5, s.middle, 1e-12);
        // Signs of the radii do not matter, nor whole turns of a circle's axis.
        const path same = path::from_svg(fmt::format("M 0 10 A -10 10 735 {} 10 0", s.flags));
        check_at(same, 0.5, s.middle, 1e-12);
    }
}

TEST_CASE("radii that do not reach grow together until they do")
{
    const path circle = path::from_svg("M 0 0 A 1 1 0 0 1 20 0");
    CHECK(circle.length_mm() == doctest::Approx(10.0 * pi).epsilon(1e-14));
    check_at(circle, 0.5, {10.0, -10.0}, 1e-12);
    // Grown tenfold: 20 by 10, of which the chord is the longer axis, turned upright.
    const path ellipse = path::from_svg("M 5 0 A 2 1 90 1 0 5 40");
    check_at(ellipse, 0.5, {-5.0, 20.0}, 1e-12);
    CHECK(ellipse.length_mm() == doctest::Approx(48.442241102738381).epsilon(1e-12));
    CHECK(path::from_svg("M 0 0 A 1e-300 1e-300 0 0 1 20 0").length_mm() ==
          doctest::Approx(10.0 * pi).epsilon(1e-14));
}

TEST_CASE("an arc with a radius of 0 is a line, and an arc to its start is nothing")
{
    for (const char* data : {"M 0 0 A 0 5 0 0 1 3 4", "M 0 0 A 5 0 30 1 0 3 4", "M 0 0 A 0 0 0 0 0 3 4"}) {
        CHECK(path::from_svg(data).length_mm() == 5.0);
        CHECK(path::from_svg(data).svg() == "M 0 0 L 3 4");
    }
    CHECK(path::from_svg("M 0 0 H 3 a 5 5 0 0 1 0 0 v 4").length_mm() == 7.0);
    CHECK(path::from_svg("M 5 5 A 1 1 0 0 0 5 5").length_mm() == 0.0);
}

TEST_CASE("a turned ellipse's quarter ends on its axes")
{
    // Axes 20 and 5, turned by asin 0.6: from the end of the one to the end of the other.
    const double turn = std::asin(0.6) * 180.0 / pi;
    const path p = path::from_svg(fmt::format("M 16 12 A 20 5 {} 0 1 -3 4", turn));
    CHECK(p.length_mm() == doctest::Approx(21.446054437892).epsilon(1e-12)); // 20 E(sqrt(15) / 4)
    const point m = p.at(0.5 * p.length_mm());
    const double along = (0.8 * m.x_mm + 0.6 * m.y_mm) / 20.0;
    const double across = (0.8 * m.y_mm - 0.6 * m.x_mm) / 5.0;
    CHECK(along * along + across * across == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("further pairs of a move are lines, and a command goes on without its letter")
{
    CHECK(path::from_svg("M1 2 3 4 5 6").svg() == "M 1 2 L 3 4 L 5 6");
    CHECK(path::from_svg("m1 2 3 4 5 6").svg() == "M 1 2 L 4 6 L 9 12");
    CHECK(path::from_svg("M0 0H1 2 3v1 2").svg() == "M 0 0 L 1 0 L 2 0 L 3 0 L 3 1 L 3 3");
    CHECK(path::from_svg("M0 0C1 2 3 4 5 6 7 8 9 10 11 12").svg() == "M 0 0 C 1 2 3 4 5 6 C 7 8 9 10 11 12");
    CHECK(path::from_svg("M1 1c1 1 2 2 3 0 1 1 2 2 3 0").svg() == "M 1 1 C 2 2 3 3 4 1 C 5 2 6 3 7 1");
}

TEST_CASE("S and T mirror the last handle of their own kind only")
{
    CHECK(path::from_svg("M0 0C0 4 4 8 8 8S16 4 16 0").svg() == "M 0 0 C 0 4 4 8 8 8 C 12 8 16 4 16 0");
    CHECK(path::from_svg("M0 0S16 4 16 0").svg() == "M 0 0 C 0 0 16 4 16 0");
    CHECK(path::from_svg("M0 0C0 4 4 8 8 8L9 9S16 4 16 0").svg() ==
          "M 0 0 C 0 4 4 8 8 8 L 9 9 C 9 9 16 4 16 0");
    CHECK(path::from_svg("M0 0Q3 6 6 0T12 0T18 0").svg() ==
          "M 0 0 C 2 4 4 4 6 0 C 8 -4 10 -4 12 0 C 14 4 16 4 18 0");
    // After another kind: T begins at the point, a line drawn as a curve.
    CHECK(path::from_svg("M0 0C0 4 4 8 6 6T12 0").svg() == path::from_svg("M0 0C0 4 4 8 6 6Q6 6 12 0").svg());
    CHECK(path::from_svg("M0 0Q3 6 6 0a1 1 0 0 0 0 0T12 0").svg() ==
          path::from_svg("M0 0Q3 6 6 0Q6 0 12 0").svg());
}

} // namespace path_arcs_test
