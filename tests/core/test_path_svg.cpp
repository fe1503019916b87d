// SPDX-License-Identifier: MIT
// Path data of SVG, and where paths meet lines.
#include <clocale>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

namespace path_svg_test {

using tactor::path;
using tactor::point;

namespace {

std::string refusal(const std::string& data)
{
    return caught_message([&] { return path::from_svg(data); });
}

} // namespace

TEST_CASE("bad path data is refused at the first bad column")
{
    const refused_text samples[] = {
        {"", "path data: column 1: it is empty (start the path with M x y)"},
        {" \t\n", "path data: column 4: it is empty"},
        {"L 1 1", "path data: column 1: 'L' cannot start a path (start the path with M x y)"},
        {"M 0 0 L 1 1 garbage", "path data: column 13: 'g' is not a path command"},
        {"M 0 0 L 1", "path data: column 10: a number of L is missing before the end (give L 2 numbers)"},
        {"M 0 0 L 1 1 2", "path data: column 14: a number of L is missing before the end"},
        {"M 0 0 L 1 x", "path data: column 11: a number of L is missing before 'x'"},
        {"M 0 0,L 1 1",
         "path data: column 7: a number is missing before 'L' (write a number after each comma)"},
        {"M 0 0 L 1,,1", "path data: column 11: a number of L is missing before ','"},
        {"M 0 0 L 1 1,", "path data: column 13: a number is missing before the end"},
        {"M nan 0 L 1 1", "path data: column 3: a number of M is missing before 'n'"},
        {"M 0 0 L inf 1", "path data: column 9: a number of L is missing before 'i'"},
        {"M 0 0 L 0x10 1", "path data: column 10: a number of L is missing before 'x'"},
        {"M 0 0 L 1e400 1", "path data: column 9: inf is beyond 1e+06 (check the unit)"},
        {"M 0 0 L 5 -1000001", "path data: column 11: -1e+06 is beyond 1e+06"},
        {"M 0 0 A 1 1 0 2 0 5 5", "path data: column 15: a flag of A is missing before '2' (use 0 or 1)"},
        {"M 0 0 A 1 1 0 0 0 5", "path data: column 20: a number of A is missing before the end"},
        {"M 0 0 Z 5", "path data: column 9: '5' is not a path command"},
        {"M 0 0 L 1 1 \xc3\xa9", "path data: column 13: "},
        {std::string("M 0 0 L 1 1\0", 12), "path data: column 12: '?' is not a path command"},
        {"M 0 0 L 1 1 M 5 5", "path data: column 13: a second subpath begins (give one stroke for each)"},
        {"M 0 0 L 1 1 M 5 5 L 6 6", "path data: column 13: a second subpath begins"},
        {"M 0 0 L 1 1 Z L 5 5", "path data: column 15: a second subpath begins"},
        {"M 0 0 M 1 1 L 2 2", "path data: column 7: a second subpath begins"},
        {"M 900000 0 l 900000 0", "path data: it goes to 1.8e+06 mm, beyond 1e+06 mm"},
    };
    check_messages(samples, refusal);
}

TEST_CASE("numbers may run together, as minifiers write them")
{
    CHECK(path::from_svg("M.5.5-1-2").svg() == "M 0.5 0.5 L -1 -2");
    CHECK(path::from_svg("M0 0l1e1.5").svg() == "M 0 0 L 10 0.5");
    CHECK(path::from_svg("M0,0,+3,4").svg() == "M 0 0 L 3 4");
    CHECK(path::from_svg("\n\tM0 0\r\nL3 4\f").svg() == "M 0 0 L 3 4");
    CHECK(path::from_svg("M0 0a5 5 0 0110 0").length_mm() ==
          doctest::Approx(15.70796326794897).epsilon(1e-9));
    CHECK(path::from_svg("M0 0a5 5 0 0,1,10,0,5 5 0 0,1-10,0").length_mm() ==
          doctest::Approx(31.41592653589793).epsilon(1e-9));
    CHECK(path::from_svg("M0 0L1e-400 3").svg() == "M 0 0 L 0 3");
}

TEST_CASE("svg() draws ellipses as flat as a line as lines")
{
    for (const std::string data :
         {"M0 0a5 5 0 0,0,100,1-10-1e-60 0,1010,0", "M 100 1 A 10 1e-60 0 1 0 110 1",
          "M 0 0 A 10 1e-9 0 1 1 5 0", "M 5 5 A 1e-12 20 0 0 1 5 9", "M 5 5 A 20 1e-30 90 1 0 5 9"}) {
        CAPTURE(data);
        const path p = path::from_svg(data);
        const path again = path::from_svg(p.svg());
        CHECK(again.length_mm() == doctest::Approx(p.length_mm()).epsilon(1e-9));
        for (int k = 0; k <= 100; ++k)
            CHECK(distance_mm(again.at(p.length_mm() * k / 100.0), p.at(p.length_mm() * k / 100.0)) < 1e-5);
    }
}

TEST_CASE("numbers are read and written alike in a locale with a decimal comma")
{
    const std::string data = "M 0.5 1.25 C 2.5 3.5 4.5 5.5 6.5 7.25";
    const std::string csv = "t_s,x_mm,y_mm\n0.25,1.5,2.5\n1.75,3.5,4.5\n";
    const std::string svg = "<svg width='10.5mm' height='10.5mm' viewBox='0 0 21 21'>"
                            "<path d='M 1.5 2.5 L 3.5 4.5' transform='translate(0.5,1.5)'/></svg>";
    const std::string before = std::setlocale(LC_ALL, nullptr);
    if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr && std::setlocale(LC_ALL, "fr_FR.UTF-8") == nullptr)
        MESSAGE("neither de_DE.UTF-8 nor fr_FR.UTF-8 is installed: make one with localedef");
    REQUIRE(std::string(std::localeconv()->decimal_point) == ",");
    CHECK(path::from_svg(data).svg() == data);
    const auto timed = tactor::parse_strokes_csv(csv, "a.csv");
    CHECK_FALSE(timed.at(0).start_s.has_value()); // its first line is its zero
    CHECK(timed.at(0).motion.position(1.5) == tactor::point{3.5, 4.5});
    const auto drawn = tactor::parse_strokes_svg(svg, "a.svg");
    CHECK(drawn.at(0).motion.position(0.0).x_mm == doctest::Approx(1.0));
    CHECK(drawn.at(0).motion.position(0.0).y_mm == doctest::Approx(2.0));
    std::setlocale(LC_ALL, before.c_str());
}

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

TEST_CASE("no meeting lies beyond the end of the path, not even by a rounding")
{
    // Found by the fuzzer: the sum of these lengths was 3e-14 mm longer than the path.
    const path p = path::from_svg("M 0 0 C 0 10 0 1 10 5t10 50 0 10 C 0 10 0 10 10 20 Q 1 2 3 -1e-64");
    const std::vector<double> all = p.meets_y(0.0);
    REQUIRE_FALSE(all.empty());
    CHECK(all.back() <= p.length_mm());
    CHECK(all.back() == doctest::Approx(p.length_mm()));
}

} // namespace path_svg_test
