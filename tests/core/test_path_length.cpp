// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <boost/math/quadrature/gauss.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>

#include "core/path/shape.hpp"
#include "rounds.hpp"

namespace path_length_test {

using tactor::path;
using tactor::point;
using tactor::test::rounds;

namespace {

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

TEST_CASE("the parts of a Bezier are as long as the whole, from nanometres to a kilometre")
{
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

TEST_CASE("several nodes at once give the last digit of Boost's quadrature")
{
    std::mt19937_64 g(15);
    std::uniform_real_distribution<double> place(-50.0, 50.0);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int round = 0; round < rounds(20000); ++round) {
        tactor::detail::cubic c{};
        for (point& p : c.p)
            p = {place(g), place(g)};
        double from = part(g);
        double to = part(g);
        if (to < from)
            std::swap(from, to);
        const auto speed = [&](double t) {
            const double r = 1.0 - t;
            const auto& p = c.p;
            const auto along = [&](double a, double b, double z, double y) {
                return 3.0 * r * r * (b - a) + 6.0 * r * t * (z - b) + 3.0 * t * t * (y - z);
            };
            const double dx = along(p[0].x_mm, p[1].x_mm, p[2].x_mm, p[3].x_mm);
            const double dy = along(p[0].y_mm, p[1].y_mm, p[2].y_mm, p[3].y_mm);
            return std::sqrt(dx * dx + dy * dy);
        };
        REQUIRE(tactor::detail::cubic_length(c, from, to) ==
                boost::math::quadrature::gauss<double, 15>::integrate(speed, from, to));
    }
}

} // namespace path_length_test
