// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <tactor/path.hpp>

#include "path_samples.hpp"
#include "rounds.hpp"

namespace path_meets_test {

using tactor::path;
using tactor::point;

namespace {

const double pi = std::numbers::pi;

void check_same(const std::vector<double>& got, const std::vector<double>& want, double within = 1e-9)
{
    REQUIRE(got.size() == want.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
        CAPTURE(i);
        CHECK(std::abs(got[i] - want[i]) <= within);
    }
}

} // namespace

TEST_CASE("a straight line meets a line of the grid once, where it crosses it")
{
    const path p = path::from_svg("M 10 30 L 45 10");
    const double l = p.length_mm();
    check_same(p.meets_x(15.0), {l / 7.0}, 1e-12);
    check_same(p.meets_y(15.0), {0.75 * l}, 1e-12);
    check_same(p.meets_x(46.0), {});
    check_same(p.meets_x(9.0), {});
}

TEST_CASE("start and end on the line are meetings")
{
    const path p = path::from_svg("M 10 30 L 45 10");
    check_same(p.meets_y(30.0), {0.0}, 0.0);
    check_same(p.meets_y(10.0), {p.length_mm()}, 0.0);
    check_same(p.meets_x(10.0), {0.0}, 0.0);
    const path closed = path::from_svg("M 0 0 H 10 V 10 Z");
    check_same(closed.meets_y(5.0), {15.0, 20.0 + std::sqrt(50.0)});
}

TEST_CASE("a stretch along the line gives nothing, not even at its ends")
{
    const path p = path::from_svg("M 0 10 L 10 20 H 30 L 40 30");
    check_same(p.meets_y(20.0), {});
    check_same(p.meets_y(20.0 + 5e-7), {});
    check_same(p.meets_x(20.0), {std::sqrt(200.0) + 10.0});
    // Along at the start, at the end, and back again.
    check_same(path::from_svg("M 0 20 H 10 V 30").meets_y(20.0), {});
    check_same(path::from_svg("M 0 30 V 20 H 10").meets_y(20.0), {});
    check_same(path::from_svg("M 0 20 H 10 H 5 V 30").meets_y(20.0), {});
    // In several pieces, one of them a curve.
    check_same(path::from_svg("M 0 10 V 20 H 5 C 6 20 7 20 8 20 H 9 V 10").meets_y(20.0), {});
    // Along one line, across another, then across the first.
    check_same(path::from_svg("M 0 10 V 20 H 5 V 30 H 20 V 0").meets_y(20.0),
               {10.0 + 5.0 + 10.0 + 15.0 + 10.0});
}

TEST_CASE("a joint of two segments on the line is one meeting")
{
    check_same(path::from_svg("M 0 0 L 5 20 L 10 40").meets_y(20.0), {std::hypot(5.0, 20.0)});
    check_same(path::from_svg("M 0 0 L 5 20 L 10 0").meets_y(20.0), {std::hypot(5.0, 20.0)});
    check_same(path::from_svg("M 0 0 L 5 20 L 5 20.0000001 L 10 40").meets_y(20.0), {std::hypot(5.0, 20.0)},
               1e-6);
    check_same(path::from_svg("M 0 0 C 1 10 4 15 5 20 C 6 25 9 35 10 40").meets_y(20.0).size() == 1
                   ? std::vector<double>{1.0}
                   : std::vector<double>{},
               {1.0});
}

TEST_CASE("a tangent is one meeting")
{
    const path circle = path::arc({20.0, 20.0}, 16.0, 0.0, 360.0);
    check_same(circle.meets_y(36.0), {8.0 * pi}, 1e-6);
    check_same(circle.meets_y(36.0 + 5e-7), {8.0 * pi}, 1e-6);
    check_same(circle.meets_y(36.0 + 2e-6), {});
    const double half = 16.0 * std::acos(1.0 - 2e-6 / 16.0);
    check_same(circle.meets_y(36.0 - 2e-6), {8.0 * pi - half, 8.0 * pi + half}, 1e-7);
    check_same(circle.meets_x(36.0), {0.0, 32.0 * pi}, 1e-9);
    // A parabola's vertex on the line.
    const path p = path::from_svg("M 0 0 Q 10 20 20 0");
    check_same(p.meets_y(10.0), {0.5 * p.length_mm()}, 1e-6);
}

TEST_CASE("an inflection on the line is one meeting")
{
    const path p = path::from_svg("M 0 0 C 10 20 10 0 20 20");
    check_same(p.meets_y(10.0), {0.5 * p.length_mm()}, 1e-6);
    // Level where two pieces join.
    const path level = path::from_svg("M 0 0 C 0 10 0 10 0 10 C 0 10 0 10 10 20");
    check_same(level.meets_y(10.0), {10.0}, 1e-6);
}

TEST_CASE("the half circle of the paper meets the grid by geometry")
{
    const path p = path::arc({20.0, 20.0}, 16.0, -90.0, -180.0);
    check_same(p.meets_x(20.0), {0.0, 16.0 * pi}, 1e-12);
    check_same(p.meets_y(20.0), {8.0 * pi}, 1e-9);
    check_same(p.meets_x(0.0), {});
    check_same(p.meets_y(40.0), {});
    const double a = 16.0 * std::acos(10.0 / 16.0);
    check_same(p.meets_y(10.0), {a}, 1e-9);
    check_same(p.meets_x(10.0), {16.0 * std::asin(10.0 / 16.0), 16.0 * pi - 16.0 * std::asin(10.0 / 16.0)},
               1e-9);
}

TEST_CASE("a circle in fine steps touches its tangent once")
{
    for (const int n : {1000, 10000, 100001}) {
        std::vector<point> points;
        for (int k = 0; k <= n; ++k) {
            const double a = 2.0 * pi * k / n;
            points.push_back({20.0 + 16.0 * std::cos(a), 20.0 + 16.0 * std::sin(a)});
        }
        CAPTURE(n);
        check_same(path::polyline(points).meets_y(36.0), {8.0 * pi}, 0.06);
    }
}

TEST_CASE("a non-number as a line is never met")
{
    const path p = path::from_svg("M 0 0 L 1 1");
    CHECK(p.meets_x(std::numeric_limits<double>::quiet_NaN()).empty());
    CHECK(p.meets_y(std::numeric_limits<double>::infinity()).empty());
    CHECK(p.meets_y(1e300).empty());
}

TEST_CASE("every meeting is on the line, in order, and no crossing is missed")
{
    std::mt19937_64 random(4242);
    std::uniform_real_distribution<double> line(-60.0, 60.0);
    for (int n = 0; n < tactor::test::rounds(1500); ++n) {
        const std::string data = tactor::test::random_path(random, 1 + n % 7);
        const double x = line(random);
        CAPTURE(data);
        CAPTURE(x);
        const path p = path::from_svg(data);
        const std::vector<double> s = p.meets_x(x);
        bool on_line = true;
        bool in_order = true;
        for (std::size_t i = 0; i < s.size(); ++i) {
            on_line = on_line && std::abs(p.at(s[i]).x_mm - x) < 2e-6;
            in_order = in_order && (i == 0 || s[i] > s[i - 1]);
        }
        CHECK(on_line);
        CHECK(in_order);
        // Between two meetings, the path stays on one side.
        std::vector<double> bounds = s;
        bounds.insert(bounds.begin(), 0.0);
        bounds.push_back(p.length_mm());
        bool one_side = true;
        for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
            int left = 0;
            int right = 0;
            for (int k = 1; k < 100; ++k) {
                const double off = p.at(bounds[i] + (bounds[i + 1] - bounds[i]) * k / 100.0).x_mm - x;
                left += off < -2e-6 ? 1 : 0;
                right += off > 2e-6 ? 1 : 0;
            }
            one_side = one_side && (left == 0 || right == 0);
        }
        CHECK(one_side);
    }
}

TEST_CASE("a curve and the same curve turned by a right angle meet the grid alike")
{
    std::mt19937_64 random(99);
    std::uniform_real_distribution<double> n(-50.0, 50.0);
    for (int k = 0; k < 500; ++k) {
        const double a = n(random), b = n(random), c = n(random), d = n(random), e = n(random), f = n(random);
        const path p = path::from_svg(fmt::format("M 0 0 C {} {} {} {} {} {}", a, b, c, d, e, f));
        const path q = path::from_svg(fmt::format("M 0 0 C {} {} {} {} {} {}", b, a, d, c, f, e));
        check_same(p.meets_x(7.0), q.meets_y(7.0), 1e-9);
    }
}

TEST_CASE("no meeting lies beyond the end of the path, not even by a rounding")
{
    // Found by the fuzzer: the sum of these lengths was 3e-14 mm longer than the path.
    const path p = path::from_svg("M 0 0 C 0 10 0 1 10 5t10 50 0 10 C 0 10 0 10 10 20 Q 1 2 3 -1e-64");
    const std::vector<double> all = p.meets_y(0.0);
    REQUIRE_FALSE(all.empty());
    CHECK(all.back() <= p.length_mm());
    CHECK(all.back() == doctest::Approx(p.length_mm()));
}

} // namespace path_meets_test
