// SPDX-License-Identifier: MIT
// Faces of arrays, ordinary and extreme.
#include <algorithm>
#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "core/access.hpp"
#include "plan/faces/layout_impl.hpp"
#include "rounds.hpp"

namespace layout_test {

using namespace tactor;
using namespace tactor::test;

namespace {

double area(const layout& l, const std::vector<unsigned>& f)
{
    double sum = 0.0;
    for (std::size_t i = 2; i < f.size(); ++i)
        sum += cross(l.places()[f[0]], l.places()[f[i - 1]], l.places()[f[i]]) / 2.0;
    return sum;
}

double covered(const layout& l)
{
    double sum = 0.0;
    for (const auto& f : l.faces())
        sum += area(l, f);
    return sum;
}

double hull_area(const layout& l)
{
    const auto& h = detail::access::of(l).hull;
    double sum = 0.0;
    for (std::size_t i = 2; i < h.size(); ++i)
        sum += cross(h[0], h[i - 1], h[i]) / 2.0;
    return sum;
}

std::vector<std::size_t> sizes(const layout& l)
{
    std::vector<std::size_t> s;
    for (const auto& f : l.faces())
        s.push_back(f.size());
    std::sort(s.begin(), s.end());
    return s;
}

} // namespace

TEST_CASE("the cells of a rectangular grid are its faces, at any turn and pitch")
{
    generator g(11);
    for (unsigned round = 0; round < 300; ++round) {
        const unsigned rows = pick(g, 2, 9);
        const unsigned columns = pick(g, 2, 9);
        const double turn = round % 3 == 0 ? 0.0 : between(g, 0.0, 6.3);
        const layout l(
            rotated(make_grid("g", rows, columns, between(g, 1.0, 50.0), between(g, 1.0, 50.0)), turn));
        CAPTURE(round);
        REQUIRE(sizes(l) == std::vector<std::size_t>((rows - 1) * (columns - 1), 4));
        REQUIRE(covered(l) == doctest::Approx(hull_area(l)).epsilon(1e-12));
    }
}

TEST_CASE("grids given to the micrometre and coarser pitches keep their cells")
{
    array a = make_grid("g", 4, 5, 100.0 / 3.0, 100.0 / 7.0);
    for (tactor_spec& t : a.tactors)
        t.position = {std::round(t.position.x_mm * 1e6) / 1e6, std::round(t.position.y_mm * 1e6) / 1e6};
    CHECK(sizes(layout(a)) == std::vector<std::size_t>(12, 4));
}

TEST_CASE("a ring is one face, with its centre a face for each neighbouring pair")
{
    generator g(12);
    for (unsigned n = 3; n < 200; n += n < 20 ? 1 : 13) {
        const double turn = between(g, 0.0, 6.3);
        const layout ring(make_ring(n, 25.0, false, turn));
        CAPTURE(n);
        REQUIRE(ring.faces().size() == 1);
        REQUIRE(ring.faces()[0].size() == n);
        const layout wheel(make_ring(n, 25.0, true, turn));
        REQUIRE(wheel.faces().size() == (n == 4 ? 4 : n));
        REQUIRE(covered(wheel) == doctest::Approx(hull_area(wheel)).epsilon(1e-12));
    }
    // Written to six decimals.
    array a = make_ring(48, 30.0, false);
    for (tactor_spec& t : a.tactors)
        t.position = {std::round(t.position.x_mm * 1e6) / 1e6, std::round(t.position.y_mm * 1e6) / 1e6};
    CHECK(layout(a).faces().size() == 1);
}

TEST_CASE("faces are Delaunay: no tactor in the circle round one, every tactor in a face, the hull covered")
{
    generator g(13);
    for (unsigned round = 0; round < 200; ++round) {
        const array a = round % 2 == 0 ? cloud(g, pick(g, 3, 60)) : some_array(g, round / 2 % 5);
        const layout l(a);
        CAPTURE(round);
        REQUIRE(covered(l) == doctest::Approx(hull_area(l)).epsilon(1e-9));
        std::set<unsigned> seen;
        for (const auto& f : l.faces()) {
            seen.insert(f.begin(), f.end());
            REQUIRE(area(l, f) > 0.0);
            const auto& t = l.places();
            const point o = t[f[0]];
            const point u{t[f[1]].x_mm - o.x_mm, t[f[1]].y_mm - o.y_mm};
            const point v{t[f[2]].x_mm - o.x_mm, t[f[2]].y_mm - o.y_mm};
            const double uu = u.x_mm * u.x_mm + u.y_mm * u.y_mm;
            const double vv = v.x_mm * v.x_mm + v.y_mm * v.y_mm;
            const double d = 2.0 * cross(o, t[f[1]], t[f[2]]);
            const point centre{o.x_mm + (v.y_mm * uu - u.y_mm * vv) / d,
                               o.y_mm + (u.x_mm * vv - v.x_mm * uu) / d};
            const double radius = distance_mm(centre, o);
            for (unsigned i = 0; i < t.size(); ++i) {
                const bool member = std::find(f.begin(), f.end(), i) != f.end();
                const double off = distance_mm(centre, t[i]) - radius;
                if (member)
                    REQUIRE(std::abs(off) < 1e-5 * (1.0 + radius / 100.0));
                else
                    REQUIRE(off > -1e-5 * (1.0 + radius / 100.0));
            }
        }
        REQUIRE(seen.size() == a.tactors.size());
    }
}

TEST_CASE("the hull holds its edge within a nanometre, and nearest() lies on it")
{
    generator g(15);
    const layout l(preset_array("palm-3x3"));
    CHECK(l.contains({40.0 + 0.9e-6, 20.0}));
    CHECK_FALSE(l.contains({40.0 + 1.1e-6, 20.0}));
    CHECK_FALSE(l.contains({not_a_number, 20.0}));
    CHECK(l.nearest({50.0, 50.0}) == point{40.0, 40.0});
    CHECK(l.nearest({13.0, -5.0}) == point{13.0, 0.0});
    CHECK_THROWS_AS(l.nearest({not_a_number, 0.0}), error);
    for (unsigned round = 0; round < 2000; ++round) {
        const layout m(some_array(g, round % kinds_of_array));
        const point p{between(g, -150.0, 150.0), between(g, -150.0, 150.0)};
        const point q = m.nearest(p);
        CAPTURE(round);
        REQUIRE(m.contains(q));
        if (m.contains(p)) {
            REQUIRE(distance_mm(p, q) <= same_place_mm);
            continue;
        }
        // No point of the hull is nearer: in a convex hull the tactors' side is enough.
        for (const point& t : m.places())
            REQUIRE((t.x_mm - q.x_mm) * (p.x_mm - q.x_mm) + (t.y_mm - q.y_mm) * (p.y_mm - q.y_mm) <= 1e-6);
    }
}

TEST_CASE("every place of a grid is inside, even on the diagonals of the hull")
{
    generator g(29);
    for (unsigned round = 0; round < 2000; ++round) {
        const double x_mm = between(g, 0.1, 50.0);
        const double y_mm = between(g, 0.1, 50.0);
        const unsigned n = 3 + round % 3;
        CAPTURE(x_mm);
        CAPTURE(y_mm);
        const layout l(make_grid("grid", n, n, x_mm, y_mm));
        for (const point p : l.places()) {
            CHECK(l.contains(p));
            CHECK(distance_mm(l.nearest(p), p) <= same_place_mm);
        }
    }
    const layout found(make_grid("grid", 4, 4, 49.547345412160652, 0.14901599888563485));
    CHECK(found.contains(found.places()[5]));
}

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
                         doctest::Contains("too close"), error);
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

} // namespace layout_test
