// SPDX-License-Identifier: MIT
// Paths: polylines, curves and arcs, and their lengths.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/path.hpp>

#include "caught.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

namespace path_test {

using tactor::path;
using tactor::point;
using tactor::test::rounds;

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

void check_share(const path& p, double share, point want, double within)
{
    CAPTURE(p.svg());
    check_at(p, share * p.length_mm(), want, within);
}

using control = std::array<point, 4>;

path bezier(const control& p)
{
    return path::from_svg(fmt::format("M {} {} C {} {} {} {} {} {}", p[0].x_mm, p[0].y_mm, p[1].x_mm,
                                      p[1].y_mm, p[2].x_mm, p[2].y_mm, p[3].x_mm, p[3].y_mm));
}

point mix(point a, point b, double t)
{
    return {a.x_mm + t * (b.x_mm - a.x_mm), a.y_mm + t * (b.y_mm - a.y_mm)};
}

// De Casteljau: the curve up to t and from t.
std::array<control, 2> split(const control& p, double t)
{
    const point a = mix(p[0], p[1], t), b = mix(p[1], p[2], t), c = mix(p[2], p[3], t);
    const point d = mix(a, b, t), e = mix(b, c, t), m = mix(d, e, t);
    return {control{p[0], a, d, m}, control{m, e, c, p[3]}};
}

} // namespace

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
        return caught_message([&] { return path::polyline(p); });
    };
    CHECK(polyline({}).find("has no point") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {nan, 1.0}}).find("not finite") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {1.0, -inf}}).find("not finite") != std::string::npos);
    CHECK(polyline({{1.0, 1.0}, {2e6, 1.0}}).find("beyond") != std::string::npos);

    const auto arc = [](point c, double r, double from, double sweep) {
        return caught_message([&] { return path::arc(c, r, from, sweep); });
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

TEST_CASE("a half circle is one anywhere, though its ends are rounded")
{
    for (int k = 1; k <= 500; ++k) {
        const double x = 0.1 * k;
        const path p = path::from_svg(fmt::format("M {} {} a 3.3 3.3 0 0 1 6.6 0", x, 0.7 * x));
        CHECK(p.length_mm() == doctest::Approx(3.3 * pi).epsilon(1e-13));
        check_share(p, 0.5, {x + 3.3, 0.7 * x - 3.3}, 1e-12);
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
        check_share(p, 0.5, s.middle, 1e-12);
        // Signs of the radii do not matter, nor whole turns of a circle's axis.
        const path same = path::from_svg(fmt::format("M 0 10 A -10 10 735 {} 10 0", s.flags));
        check_share(same, 0.5, s.middle, 1e-12);
    }
}

TEST_CASE("radii that do not reach grow together until they do")
{
    const path circle = path::from_svg("M 0 0 A 1 1 0 0 1 20 0");
    CHECK(circle.length_mm() == doctest::Approx(10.0 * pi).epsilon(1e-14));
    check_share(circle, 0.5, {10.0, -10.0}, 1e-12);
    // Grown tenfold: 20 by 10, of which the chord is the longer axis, turned upright.
    const path ellipse = path::from_svg("M 5 0 A 2 1 90 1 0 5 40");
    check_share(ellipse, 0.5, {-5.0, 20.0}, 1e-12);
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

TEST_CASE("the parts of a Bezier are as long as the whole, from nanometres to a kilometre")
{
    // A parabola's length has a closed form: y = x^2 from 0 to 1.
    CHECK(path::from_svg("M 0 0 Q 0.5 0 1 1").length_mm() ==
          doctest::Approx(0.5 * std::sqrt(5.0) + 0.25 * std::asinh(2.0)).epsilon(1e-10));
    std::mt19937_64 random(1848);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::uniform_real_distribution<double> exponent(-9.0, 5.9);
    const auto number = [&] {
        const double v = std::pow(10.0, exponent(random));
        return unit(random) < 0.5 ? -v : v;
    };
    int tried = 0;
    for (int n = 0; n < rounds(10000); ++n) {
        control p;
        for (point& q : p)
            q = {number(), n % 3 == 0 ? 0.0 : number()};
        if (n % 3 == 0)
            for (point& q : p)
                q.y_mm = 0.5 * q.x_mm; // back and forth on a line
        if (n % 5 == 0)
            p[1] = p[0];
        if (n % 7 == 0)
            p[2] = p[3];
        const double t = unit(random);
        const auto parts = split(p, t);
        const double first = bezier(parts[0]).length_mm();
        const double both = first + bezier(parts[1]).length_mm();
        if (first == 0.0 || both == first)
            continue; // a part so short that it is one place
        ++tried;
        const path whole = bezier(p);
        CAPTURE(whole.svg());
        CAPTURE(t);
        CHECK(std::abs(whole.length_mm() - both) < 1e-6);
        CHECK(tactor::distance_mm(whole.at(first), parts[0][3]) < 1e-5);
    }
    CHECK(tried > rounds(9000));
}

TEST_CASE("flat ellipses turn sharply and keep their length")
{
    // To first order in b/a, the circumference is 4a (1 + (b/a)^2 (ln(4a/b) - 1/2) / 2).
    for (const double b : {1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-6}) {
        CAPTURE(b);
        const path p = path::from_svg(fmt::format("M 100 0 A 100 {0} 0 0 1 -100 0 A 100 {0} 0 0 1 100 0", b));
        const double k = b / 100.0;
        const double want = 400.0 * (1.0 + 0.5 * k * k * (std::log(4.0 / k) - 0.5));
        CHECK(std::abs(p.length_mm() - want) < 1e-5 * b + 1e-7);
        CHECK(tactor::distance_mm(p.at(0.25 * p.length_mm()), {0.0, b}) < 1e-6);
        CHECK(tactor::distance_mm(p.at(0.5 * p.length_mm()), {-100.0, 0.0}) < 1e-6);
    }
}

} // namespace path_test
