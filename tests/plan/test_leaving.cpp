// SPDX-License-Identifier: MIT
// A continuous stroke that leaves the array is refused, however short the way out and however long the
// stroke.
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "arrays.hpp"
#include "rounds.hpp"
#include "strokes.hpp"

namespace leaving_test {

using namespace tactor;
using namespace tactor::test;

namespace {

plan_options continuous()
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    return o;
}

/// Returns how far a movement leaves the array, sampled at many places; and the first place outside.
struct excursion {
    double farthest_mm = 0.0;
    double first_s = -1.0;
};

excursion look(const layout& l, const trajectory& t)
{
    excursion e;
    for (int k = 0; k <= 4000; ++k) {
        const double when = t.duration_s() * k / 4000.0;
        const point p = t.position(when);
        const double out = distance_mm(p, l.nearest(p));
        e.farthest_mm = std::max(e.farthest_mm, out);
        if (out > edge_tolerance_mm && e.first_s < 0.0)
            e.first_s = when;
    }
    return e;
}

} // namespace

TEST_CASE("a way out of five milliseconds is found in a day, to the microsecond")
{
    for (const double duration : {10.0, 2000.0, 86400.0}) {
        for (const double part : {0.1234567, 0.5, 0.987654321}) {
            CAPTURE(duration);
            const double at = duration * part;
            const stroke s = timed({{0.0, {20, 20}},
                                    {at, {20, 35}},
                                    {at + 0.0025, {20, 45}},
                                    {at + 0.005, {20, 35}},
                                    {duration, {20, 20}}});
            const std::string said = refusal(palm, s, continuous());
            CHECK(said.find("leaves the array at (20.000, 40.000) mm after ") != std::string::npos);
            CHECK(number_after(said, "after ") == doctest::Approx(at + 0.00125).epsilon(1e-5));
            plan_options o = continuous();
            o.outside = outside_kind::clamp;
            CHECK(refusal(palm, s, o).empty());
        }
    }
}

TEST_CASE("curves that turn at the edge stay inside, curves that turn beyond it do not")
{
    // A parabola over the upper edge whose top is at y = 0, then a hundredth of a millimetre above.
    CHECK(refusal(palm, along("M 0 20 Q 20 -20 40 20", 86400.0), continuous()).empty());
    const std::string said = refusal(palm, along("M 0 20 Q 20 -20.02 40 20", 86400.0), continuous());
    CHECK(said.find("leaves the array at (19.") != std::string::npos);
    CHECK(
        refusal(palm, along("M 20 0 A 20 20 0 1 1 20 40 A 20 20 0 1 1 20 0", 3600.0), continuous()).empty());
    CHECK_FALSE(refusal(palm, along("M 20 0 A 20.001 20.001 0 1 1 20 40", 3600.0), continuous()).empty());
    // A slanted edge, which no turn of x or y touches.
    const array corner = make_array({{0, 0}, {40, 0}, {0, 40}});
    CHECK(refusal(corner, along("M 30 5 Q 20 24.99 5 30", 1.0), continuous()).empty());
    CHECK_FALSE(refusal(corner, along("M 30 5 Q 30 30 5 30", 1.0), continuous()).empty());
}

TEST_CASE("strokes leave arrays in one line and of one tactor")
{
    const array line = make_array({{30, 30}, {0, 0}, {10, 10}, {20, 20}});
    CHECK(refusal(line, along("M 0 0 L 30 30 L 10 10", 2.0), continuous()).empty());
    CHECK(refusal(line, along("M 5 5 C 10 10 20 20 29 29", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 5 5 C 10 10 70 70 20 20", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 5 5 Q 10 10.1 20 20", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 0 0 L 31 31", 2.0), continuous()).empty());
    const array one = make_array({{3, 4}});
    CHECK_FALSE(refusal(one, along("M 3 4 C 10 4 3 10 3 4", 1.0), continuous()).empty());
    CHECK(refusal(one, timed({{0.0, {3, 4}}, {5.0, {3, 4}}}), continuous()).empty());
}

namespace {

// Short times have smaller units.
double time_after(const std::string& said)
{
    const double v = number_after(said, "after ");
    const std::string rest = said.substr(said.find("after ") + 6);
    const std::string unit = rest.substr(rest.find(' ') + 1, 2);
    return unit == "us" ? 1e-6 * v : unit == "ns" ? 1e-9 * v : v;
}

} // namespace

TEST_CASE("a path within a hundredth of a millimetre of the array is on its edge")
{
    for (const algorithm_kind k :
         {algorithm_kind::park2016, algorithm_kind::tactile_brush, algorithm_kind::continuous}) {
        plan_options o = continuous();
        o.algorithm = k;
        const auto complaint = [&](double beyond_mm) {
            return refusal(palm, along(fmt::format("M 0 {} H 40", 40.0 + beyond_mm), 1.4), o);
        };
        CHECK(complaint(0.00043).empty());
        CHECK(complaint(0.0099).empty());
        CHECK(complaint(0.0101).find("outside") != std::string::npos);
        const plan p = make_plan(palm, along("M 0 40.00043 H 40", 1.4), o);
        for (const burst& b : p.bursts)
            CHECK(b.position.y_mm == 40.0);
    }
}

TEST_CASE("any curve on any array is refused at a place outside, or never leaves")
{
    std::mt19937_64 random(21);
    std::uniform_real_distribution<double> place(0.0, 40.0);
    int refused = 0;
    int taken = 0;
    for (int n = 0; n < rounds(300); ++n) {
        CAPTURE(n);
        std::vector<point> places;
        for (int i = 0; i < 4 + n % 7; ++i)
            places.push_back({place(random), place(random)});
        const array a = n % 2 == 0 ? palm : make_array(places);
        const layout l(a);
        const auto inside = [&] { return l.nearest({place(random), place(random)}); };
        const auto any = [&] {
            const point p = inside();
            return n % 3 == 0 ? point{1.3 * p.x_mm - 6.0, 1.3 * p.y_mm - 6.0} : p;
        };
        const point p = inside();
        std::string svg = fmt::format("M {} {}", p.x_mm, p.y_mm);
        for (int i = 0; i < 1 + n % 4; ++i) {
            const point b = any();
            const point c = any();
            const point d = any();
            if ((n + i) % 3 == 0)
                svg += fmt::format(" A {} {} {} {} {} {} {}", 1.0 + place(random), 1.0 + place(random), 5 * i,
                                   n % 2, i % 2, d.x_mm, d.y_mm);
            else if ((n + i) % 3 == 1)
                svg += fmt::format(" C {} {} {} {} {} {}", b.x_mm, b.y_mm, c.x_mm, c.y_mm, d.x_mm, d.y_mm);
            else
                svg += fmt::format(" L {} {}", d.x_mm, d.y_mm);
        }
        CAPTURE(svg);
        const stroke s = along(svg, 3.0);
        const excursion e = look(l, s.motion);
        const std::string said = refusal(a, s, continuous());
        if (said.empty()) {
            CHECK(e.farthest_mm < edge_tolerance_mm + 3e-6);
            ++taken;
            continue;
        }
        ++refused;
        if (said.find("starts outside") != std::string::npos)
            continue;
        const double when = time_after(said);
        CHECK((e.first_s < 0.0 || when <= e.first_s + 1e-5));
        const point edge = s.motion.position(when);
        CHECK(distance_mm(edge, l.nearest(edge)) < 0.002); // six digits of the time
    }
    CHECK(refused > rounds(50));
    CHECK(taken > rounds(50));
}

} // namespace leaving_test
