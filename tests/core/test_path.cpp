// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/path.hpp>

#include "caught.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

namespace path_test {

using tactor::path;
using tactor::point;

namespace {

const double pi = std::numbers::pi;

void check_at(const path& p, double s, point want, double within)
{
    const point got = p.at(s);
    CAPTURE(s);
    CAPTURE(got.x_mm);
    CAPTURE(got.y_mm);
    CHECK(tactor::distance_mm(got, want) <= within);
}

} // namespace

TEST_CASE("a straight line is exact")
{
    const path p = path::from_svg("M 0 10 L 40 30");
    CHECK(p.length_mm() == doctest::Approx(std::sqrt(2000.0)).epsilon(1e-15));
    check_at(p, 0.5 * p.length_mm(), {20.0, 20.0}, 1e-12);
    check_at(p, 0.25 * p.length_mm(), {10.0, 15.0}, 1e-12);
    CHECK(p.at(0.0) == point{0.0, 10.0});
    CHECK(p.at(p.length_mm()) == point{40.0, 30.0});
}

TEST_CASE("arc length is clamped to the path, and a non-number is its start")
{
    const path p = path::from_svg("M 1 2 L 3 4 C 5 5 6 6 7 9");
    CHECK(p.at(-1.0) == point{1.0, 2.0});
    CHECK(p.at(1e300) == point{7.0, 9.0});
    CHECK(p.at(std::numeric_limits<double>::infinity()) == point{7.0, 9.0});
    CHECK(p.at(std::numeric_limits<double>::quiet_NaN()) == point{1.0, 2.0});
}

TEST_CASE("circular arcs are good to a thousandth of a nanometre")
{
    const path p = path::arc({20.0, 20.0}, 16.0, -90.0, -180.0);
    CHECK(p.length_mm() == doctest::Approx(16.0 * pi).epsilon(1e-14));
    for (int k = 0; k <= 1000; ++k) {
        const double a = -0.5 * pi - pi * k / 1000.0;
        check_at(p, 16.0 * pi * k / 1000.0, {20.0 + 16.0 * std::cos(a), 20.0 + 16.0 * std::sin(a)}, 1e-12);
    }
    CHECK(p.at(0.0) == point{20.0, 4.0});
    CHECK(p.at(p.length_mm()) == point{20.0, 36.0});
}

TEST_CASE("a whole circle ends where it began")
{
    const path p = path::arc({1.0, 2.0}, 5.0, 33.0, 360.0);
    CHECK(p.length_mm() == doctest::Approx(10.0 * pi).epsilon(1e-14));
    CHECK(p.at(0.0) == p.at(p.length_mm()));
}

TEST_CASE("the length of an ellipse is its elliptic integral")
{
    // 4 a E(e) for a = 2, b = 1.
    const path p = path::from_svg("M 2 0 A 2 1 0 0 1 -2 0 A 2 1 0 0 1 2 0");
    CHECK(p.length_mm() == doctest::Approx(9.688448220547675).epsilon(1e-9));
}

TEST_CASE("a parabola has the length of its closed form")
{
    // y = x^2 from 0 to 1.
    const path p = path::from_svg("M 0 0 Q 0.5 0 1 1");
    CHECK(p.length_mm() == doctest::Approx(0.5 * std::sqrt(5.0) + 0.25 * std::asinh(2.0)).epsilon(1e-10));
}

TEST_CASE("arc length and its inverse hold to a micrometre on awkward curves")
{
    for (const char* data : tactor::test::awkward_curves) {
        CAPTURE(data);
        const path p = path::from_svg(data);
        const auto reference = tactor::test::walk_cubic(data);
        CHECK(std::abs(p.length_mm() - reference.s.back()) < 1e-5);
        const double scale = reference.s.back();
        for (std::size_t i = 0; i < reference.s.size(); i += 997) {
            // The reference's chords are short of the arc by less than this.
            check_at(p, reference.s[i], reference.p[i], 1e-5 + 1e-9 * scale);
        }
        check_at(p, p.length_mm(), reference.p.back(), 1e-12 * scale);
    }
}

TEST_CASE("equal steps of arc length are chords no longer than the step")
{
    std::mt19937_64 random(20160701);
    std::uniform_real_distribution<double> place(-50.0, 50.0);
    for (int n = 0; n < tactor::test::rounds(300); ++n) {
        const std::string data = tactor::test::random_path(random, 1 + n % 8);
        CAPTURE(data);
        const path p = path::from_svg(data);
        const double step = p.length_mm() / 2000.0;
        double chords = 0.0;
        point before = p.at(0.0);
        bool short_enough = true;
        for (int k = 1; k <= 2000; ++k) {
            const point now = p.at(step * k);
            const double chord = tactor::distance_mm(before, now);
            short_enough = short_enough && chord <= step + 1e-6;
            chords += chord;
            before = now;
        }
        CHECK(short_enough);
        CHECK(chords > 0.99 * p.length_mm());
    }
}

TEST_CASE("all commands of path data, absolute and relative, mean the same")
{
    const path a = path::from_svg("M 10 10 L 20 10 H 30 V 20 C 35 20 40 25 40 30 S 45 40 50 40 Q 55 40 60 45 "
                                  "T 70 50 A 10 10 0 0 1 90 50 Z");
    const path r =
        path::from_svg("m10 10l10 0h10v10c5 0 10 5 10 10s5 10 10 10q5 0 10 5t10 5a10 10 0 0120 0z");
    CHECK(a.length_mm() == doctest::Approx(r.length_mm()).epsilon(1e-12));
    for (int k = 0; k <= 200; ++k) {
        const double s = a.length_mm() * k / 200.0;
        check_at(a, s, r.at(s), 1e-9);
    }
}

TEST_CASE("Z goes back to the start, once")
{
    CHECK(path::from_svg("M 0 0 H 3 V 4 Z").length_mm() == doctest::Approx(12.0).epsilon(1e-15));
    CHECK(path::from_svg("M 0 0 H 3 V 4 L 0 0 Z").length_mm() == doctest::Approx(12.0).epsilon(1e-15));
    CHECK(path::from_svg("M 0 0 H 3 V 4 Z z").length_mm() == doctest::Approx(12.0).epsilon(1e-15));
    CHECK(path::from_svg("m 1 1 h 3 v 4 z").at(12.0) == point{1.0, 1.0});
}

TEST_CASE("zero-length pieces change nothing")
{
    const path p = path::from_svg("M 0 0 L 0 0 L 3 0 L 3 0 C 3 0 3 0 3 0 Q 3 0 3 0 A 5 5 0 0 1 3 0 L 3 4");
    CHECK(p.length_mm() == 7.0);
    check_at(p, 3.0, {3.0, 0.0}, 0.0);
    check_at(p, 5.0, {3.0, 2.0}, 1e-15);
}

TEST_CASE("svg() draws the same curve")
{
    std::mt19937_64 random(7);
    for (int n = 0; n < tactor::test::rounds(300); ++n) {
        const path p = path::from_svg(tactor::test::random_path(random, 1 + n % 6));
        CAPTURE(p.svg());
        const path q = path::from_svg(p.svg());
        CHECK(q.length_mm() == doctest::Approx(p.length_mm()).epsilon(1e-9));
        for (int k = 0; k <= 50; ++k)
            check_at(q, p.length_mm() * k / 50.0, p.at(p.length_mm() * k / 50.0), 1e-6);
    }
    const path circle = path::arc({20.0, 20.0}, 16.0, 17.0, -360.0);
    const path again = path::from_svg(circle.svg());
    for (int k = 0; k <= 50; ++k)
        check_at(again, circle.length_mm() * k / 50.0, circle.at(circle.length_mm() * k / 50.0), 1e-9);
}

TEST_CASE("a polyline is its points")
{
    const std::vector<point> points{{0.0, 0.0}, {3.0, 4.0}, {3.0, 4.0}, {3.0, 10.0}};
    const path p = path::polyline(points);
    CHECK(p.length_mm() == 11.0);
    check_at(p, 2.5, {1.5, 2.0}, 1e-15);
    check_at(p, 8.0, {3.0, 7.0}, 1e-15);
    CHECK(p.svg() == "M 0 0 L 3 4 L 3 10");
}

TEST_CASE("a million points are read and measured fast")
{
    std::vector<point> points(1'000'000);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = {0.1 * static_cast<double>(i % 2), 1e-4 * static_cast<double>(i)};
    const path p = path::polyline(points);
    const double step = std::hypot(0.1, 1e-4);
    CHECK(p.length_mm() == doctest::Approx(999'999 * step).epsilon(1e-15));
    for (std::size_t i = 1; i < points.size(); i += 1000)
        check_at(p, step * static_cast<double>(i), points[i], 1e-9);
    CHECK(p.meets_x(0.05).size() == 999'999);
}

TEST_CASE("a path may be one place")
{
    for (const path& p : {path::polyline(std::vector<point>{{1.0, 2.0}}),
                          path::polyline(std::vector<point>{{1.0, 2.0}, {1.0, 2.0}}), path::from_svg("M 1 2"),
                          path::from_svg("M 1 2 Z"), path::from_svg("M 1 2 L 1 2"),
                          path::from_svg("M 1 2 l 1e-8 0"), path::from_svg("M 1 2 A 5 5 0 0 1 1 2")}) {
        CHECK(p.length_mm() == 0.0);
        CHECK(p.svg() == "M 1 2");
        for (const double s : {-1.0, 0.0, 1.0})
            CHECK(p.at(s) == point{1.0, 2.0});
        CHECK(p.meets_x(1.0) == std::vector<double>{0.0});
        CHECK(p.meets_y(1.0).empty());
    }
}

TEST_CASE("senseless polylines and arcs are refused")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const auto polyline = [](std::vector<point> p) {
        return caught_message([&] { static_cast<void>(path::polyline(p)); });
    };
    CHECK(polyline({}).find("has no point") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {nan, 1.0}}).find("not finite") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {1.0, -inf}}).find("not finite") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {2e6, 1.0}}).find("beyond") != std::string::npos);

    const auto arc = [](point c, double r, double from, double sweep) {
        return caught_message([&] { static_cast<void>(path::arc(c, r, from, sweep)); });
    };
    CHECK(arc({}, 0.0, 0.0, 90.0).find("radius") != std::string::npos);
    CHECK(arc({}, nan, 0.0, 90.0).find("radius") != std::string::npos);
    CHECK(arc({}, inf, 0.0, 90.0).find("radius") != std::string::npos);
    CHECK(arc({nan, 0.0}, 1.0, 0.0, 90.0).find("not finite") != std::string::npos);
    CHECK(arc({999'999.5, 0.0}, 1.0, -90.0, 180.0).find("beyond") != std::string::npos);
    CHECK(arc({}, 1.0, inf, 90.0).find("angle") != std::string::npos);
    CHECK(arc({}, 1.0, 0.0, 361.0).find("sweep") != std::string::npos);
    CHECK(arc({}, 1.0, 0.0, 0.0).find("sweep") != std::string::npos);
    CHECK(arc({}, 1.0, 0.0, nan).find("sweep") != std::string::npos);
    // The last that pass, and the next.
    const auto above = [](double v) { return std::nextafter(v, 2.0 * v); };
    for (const double sign : {1.0, -1.0}) {
        CHECK(arc({}, 1.0, sign * 1e6, 90.0).empty());
        CHECK(arc({}, 1.0, above(sign * 1e6), 90.0).find("angle") != std::string::npos);
        CHECK(arc({}, 1.0, 0.0, sign * 360.0).empty());
        CHECK(arc({}, 1.0, 0.0, above(sign * 360.0)).find("sweep") != std::string::npos);
    }
    CHECK(arc({}, 1e6, 0.0, 90.0).empty());
    CHECK(arc({}, above(1e6), 0.0, 90.0).find("radius") != std::string::npos);
}

} // namespace path_test
