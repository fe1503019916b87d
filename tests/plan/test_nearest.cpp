// SPDX-License-Identifier: MIT
// The three closest tactors of the whole array, as in Park et al. 2016.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/setup.hpp>

#include "arrays.hpp"
#include "has.hpp"
#include "plan/faces/same_tactors.hpp"
#include "rounds.hpp"
#include "strokes.hpp"

namespace nearest_test {

using namespace tactor;
using namespace tactor::test;

namespace {

std::vector<drive> nearest(const layout& l, point p, double a_v = 1.0)
{
    return weights(l, phantom_kind::inverse_distance, p, a_v, faces_kind::nearest);
}

/// Sorts tactors by distance, equal ones in the order of the list.
std::vector<unsigned> by_distance(const layout& l, point p)
{
    std::vector<unsigned> order;
    for (unsigned i = 0; i < l.places().size(); ++i)
        order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](unsigned a, unsigned b) {
        return distance_mm(p, l.places()[a]) < distance_mm(p, l.places()[b]) - same_place_mm;
    });
    return order;
}

bool in_line(const layout& l, const std::vector<unsigned>& t)
{
    return std::abs(cross(l.places()[t[0]], l.places()[t[1]], l.places()[t[2]])) < 1e-6;
}

/// Counts over the places of a grid in the hull, at the middles of its cells.
template <class Count>
double share(const layout& l, double step_mm, const Count& counts)
{
    point high = l.places().front();
    for (const point& p : l.places())
        high = {std::max(high.x_mm, p.x_mm), std::max(high.y_mm, p.y_mm)};
    double all = 0.0;
    double some = 0.0;
    for (double y = step_mm / 2.0; y < high.y_mm; y += step_mm)
        for (double x = step_mm / 2.0; x < high.x_mm; x += step_mm)
            if (const point p{x, y}; l.contains(p)) {
                all += 1.0;
                some += counts(p) ? 1.0 : 0.0;
            }
    return some / all;
}

bool warns(const plan& p, const std::string& of)
{
    return std::any_of(p.warnings.begin(), p.warnings.end(),
                       [&](const std::string& w) { return w.find(of) != w.npos; });
}

constexpr phantom_kind followed[] = {phantom_kind::inverse_distance, phantom_kind::barycentric,
                                     phantom_kind::linear, phantom_kind::log};

struct counted {
    unsigned places = 0;
    unsigned held = 0;        ///< by what was known of an earlier one
    unsigned on_segments = 0; ///< of these
};

/// From one place of the array to another in even steps.
void walk(const phantom_model& model, const layout& l, point from, point to, unsigned steps, counted& count)
{
    const auto& three = dynamic_cast<const detail::model_of_three&>(model);
    detail::same_tactors seen;
    std::vector<drive> anew;
    std::vector<drive> drives;
    for (unsigned i = 0; i <= steps; ++i) {
        const double u = static_cast<double>(i) / steps;
        const point p =
            l.nearest({from.x_mm + u * (to.x_mm - from.x_mm), from.y_mm + u * (to.y_mm - from.y_mm)});
        model.weights(p, 0.7, anew);
        ++count.places;
        if (!seen.holds(p)) {
            detail::update_same_tactors(three, l, p, seen);
            continue;
        }
        ++count.held;
        count.on_segments += seen.on_segment ? 1 : 0;
        detail::compute_same_drives(three, l, seen, p, 0.7, drives);
        REQUIRE(drives == anew);
    }
}

} // namespace

TEST_CASE("on the paper's array the three closest are those of the face, except on the diagonals of cells")
{
    const layout l(preset_array("palm-3x3"));
    for (int i = 0; i <= 160; ++i)
        for (int k = 0; k <= 160; ++k) {
            const point p{0.25 * i, 0.25 * k};
            CAPTURE(p.x_mm);
            CAPTURE(p.y_mm);
            const int x = i % 80;
            const int y = k % 80;
            const bool on_diagonal = x != 0 && y != 0 && (x == y || x + y == 80);
            if (on_diagonal)
                REQUIRE(nearest(l, p).size() == (x == 40 ? 2 : 3));
            else
                REQUIRE(nearest(l, p) == weights(l, phantom_kind::inverse_distance, p));
        }
}

TEST_CASE("the three closest keep Eqs. (8) and (9) and are the closest, by brute force")
{
    generator g(11);
    for (unsigned round = 0; round < 300; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        const auto model = make_phantom(phantom_kind::inverse_distance, l, faces_kind::nearest);
        CHECK(model->name() == "inverse-distance");
        std::vector<drive> d;
        for (unsigned i = 0; i < 30; ++i) {
            const point p = some_point(g, l);
            const double a_v = between(g, 0.01, 3.0);
            model->weights(p, a_v, d);
            CAPTURE(round);
            CAPTURE(p.x_mm);
            CAPTURE(p.y_mm);
            REQUIRE(std::abs(energy(d) / (a_v * a_v) - 1.0) < 1e-12);
            const auto far = [&](const drive& x) { return distance_mm(p, l.places()[x.tactor]); };
            for (const drive& x : d)
                REQUIRE(far(x) * x.amplitude * x.amplitude ==
                        doctest::Approx(far(d[0]) * d[0].amplitude * d[0].amplitude).epsilon(1e-10));
            if (l.faces().empty()) {
                REQUIRE(d == weights(l, phantom_kind::inverse_distance, p, a_v));
                continue;
            }
            const double third = distance_mm(p, l.places()[by_distance(l, p)[2]]);
            for (const drive& x : d)
                REQUIRE(far(x) <= third + 3.0 * same_place_mm);
            if (d.size() == 1)
                REQUIRE(far(d[0]) <= same_place_mm);
            else if (d.size() == 2)
                REQUIRE(off_segment(l.places()[d[0].tactor], l.places()[d[1].tactor], p) <= same_place_mm);
            else
                REQUIRE(d.size() == 3);
        }
    }
}

TEST_CASE("Eq. (2) holds on a segment between two of the three closest, and nowhere else")
{
    const layout l(make_grid("g", 3, 3, 20.0, 40.0));
    CHECK(list_tactors(nearest(l, {20.0, 40.0})) == std::vector<unsigned>{4});
    CHECK(list_tactors(nearest(l, {5.0, 0.0})) == std::vector<unsigned>{0, 1});
    CHECK(list_tactors(nearest(l, {20.0, 20.0})) == std::vector<unsigned>{1, 4}); // of one column
    // Near its first tactor the second one of a long side is not among the three.
    CHECK(list_tactors(nearest(l, {20.0, 5.0})) == std::vector<unsigned>{0, 1, 2});
    CHECK(list_tactors(nearest(l, {5.0, 10.0})) == std::vector<unsigned>{0, 1, 3});
    const auto d = nearest(l, {5.0, 0.0}, 2.0);
    CHECK(d[0].amplitude == doctest::Approx(2.0 * std::sqrt(0.75)).epsilon(1e-14));
}

TEST_CASE("on a 20 x 40 mm grid the three closest are in one line in 44 % of places, and a plan warns of it")
{
    const array a = make_grid("g", 3, 3, 20.0, 40.0);
    const layout l(a);
    CHECK(share(l, 0.5, [&](point p) { return in_line(l, by_distance(l, p)); }) ==
          doctest::Approx(0.4375).epsilon(0.0001));
    plan_options o{.faces = faces_kind::nearest};
    const stroke s = along("M 0 10 L 40 10");
    const plan p = make_plan(a, l, s, o);
    CHECK(p.faces == faces_kind::nearest);
    CHECK(p.phantom == "inverse-distance");
    std::size_t lines = 0;
    for (const burst& b : p.bursts)
        lines += list_tactors(b.drives) == std::vector<unsigned>{0, 1, 2} ? 1 : 0;
    CHECK(lines > 0);
    REQUIRE(p.warnings.size() == 1);
    CHECK(
        has(p.warnings[0], "of 15 bursts lie outside the triangle of the three closest tactors, first at ("));
    has(p.warnings[0], "for " + std::to_string(lines) + " of them the three are in one line");
    has(p.warnings[0], "(use faces = delaunay)");

    o.algorithm = algorithm_kind::continuous;
    const plan c = make_plan(a, l, s, o);
    CHECK(warns(c, "of 1001 samples lie outside"));
    burst b;
    c.curve->sample(500, b);
    CHECK(b.drives == nearest(l, b.position));
    CHECK(warns(make_plan(a, l, along("M 0 10 L 40 10", 600.0), o), "samples lie outside"));

    o.algorithm = algorithm_kind::park2016;
    o.faces = faces_kind::delaunay;
    CHECK(make_plan(a, l, s, o).warnings.empty());
    CHECK_FALSE(make_plan(a, l, s, o) == p);
    o.faces = faces_kind::nearest;
    CHECK(make_plan(preset_array("palm-3x3"), preset_stroke("park2016-1"), o).warnings.empty());
}

TEST_CASE("the guide's shares hold on the example of scattered tactors")
{
    const setup s =
        load_setup(std::filesystem::path(TACTOR_SOURCE_ROOT) / "examples/arrays/scattered-12.toml");
    const layout l(*s.array);
    REQUIRE(l.places().size() == 12);
    CHECK(share(l, 0.5, [&](point p) {
              return list_tactors(nearest(l, p)) !=
                     list_tactors(weights(l, phantom_kind::inverse_distance, p));
          }) == doctest::Approx(0.576).epsilon(0.0001));
    CHECK(share(l, 0.5, [&](point p) {
              const auto t = by_distance(l, p);
              return !in_triangle(l.places()[t[0]], l.places()[t[1]], l.places()[t[2]], p);
          }) == doctest::Approx(0.376).epsilon(0.0001));
}

TEST_CASE("only inverse-distance takes faces")
{
    const array a = preset_array("palm-3x3");
    const stroke s = preset_stroke("park2016-1");
    for (const phantom_kind k :
         {phantom_kind::barycentric, phantom_kind::linear, phantom_kind::log, phantom_kind::gaussian})
        for (const algorithm_kind by : all_values<algorithm_kind>()) {
            const plan_options o{.algorithm = by, .phantom = k, .faces = faces_kind::nearest};
            const std::string said = caught_message([&] { return make_plan(a, s, o); });
            has(said, "faces: nearest works only with inverse-distance, not with ");
            has(said, std::string(to_string(k)));
            CHECK_THROWS_AS(make_phantom(k, layout(a), faces_kind::nearest), const error&);
        }
    class silent : public phantom_model {
    public:
        std::string_view name() const noexcept override { return "silent"; }
        void weights(point, double, std::vector<drive>& out) const override { out.clear(); }
    };
    plan_options o{.faces = faces_kind::nearest, .custom_phantom = std::make_shared<silent>()};
    has(caught_message([&] { return make_plan(a, s, o); }), "not with your own phantom model");

    // A stroke's own choice wins.
    stroke own = s;
    own.choices.faces = faces_kind::delaunay;
    o.custom_phantom.reset();
    CHECK(make_plan(a, own, o).faces == faces_kind::delaunay);
    own.choices.faces = faces_kind::nearest;
    own.choices.phantom = phantom_kind::log;
    has(caught_message([&] { return make_plan(a, own, {}); }), "not with log");
}

TEST_CASE("the Tactile Brush plays on the lines of the grid and reports that it ignores the faces")
{
    const array a = make_grid("g", 3, 4, 15.0, 15.0);
    const stroke s = along("M 10 30 L 45 10");
    plan_options o{.algorithm = algorithm_kind::tactile_brush};
    const plan usual = make_plan(a, s, o);
    o.faces = faces_kind::nearest;
    plan p = make_plan(a, s, o);
    CHECK(p.faces == faces_kind::delaunay);
    CHECK(warns(p, "faces = nearest is not used"));
    p.warnings = usual.warnings;
    CHECK(p == usual);
}

TEST_CASE("in arrays of all kinds, a target that is followed has the same drives to the bit")
{
    generator g(2016);
    counted all;
    for (int round = 0; round < rounds(300); ++round) {
        const array a = some_array(g, static_cast<unsigned>(round) % kinds_of_array);
        const layout l(a);
        for (const phantom_kind k : followed) {
            CAPTURE(to_string(k));
            const auto model = make_phantom(k, l);
            walk(*model, l, some_point(g, l), some_point(g, l), pick(g, 1, 2000), all);
        }
    }
    CHECK(all.held > all.places / 2);
}

TEST_CASE("in arrays of all kinds, a target that goes from tactor to tactor has the same drives to the bit")
{
    for (const phantom_kind k : followed) {
        CAPTURE(to_string(k));
        generator g(2017);
        counted all;
        for (int round = 0; round < rounds(300); ++round) {
            const array a = some_array(g, static_cast<unsigned>(round) % kinds_of_array);
            const layout l(a);
            const auto model = make_phantom(k, l);
            const auto last = static_cast<unsigned>(a.tactors.size()) - 1;
            // Beside the segment by some of what counts as on it, to either side, too.
            const double beside = 1e-6 * (static_cast<double>(pick(g, 0, 24)) - 12.0) / 10.0;
            const point from = a.tactors[pick(g, 0, last)].position;
            const point to = a.tactors[pick(g, 0, last)].position;
            walk(*model, l, {from.x_mm + beside, from.y_mm - beside}, {to.x_mm + beside, to.y_mm - beside},
                 pick(g, 1, 2000), all);
        }
        CHECK(all.on_segments > all.places / 20);
    }
}

TEST_CASE("a slow target seldom asks, on the border between two faces as little")
{
    const layout l(make_grid("3x3", 3, 3, 20.0, 20.0));
    for (const phantom_kind k : followed) {
        CAPTURE(to_string(k));
        const auto model = make_phantom(k, l);
        counted inside;
        walk(*model, l, {1.0, 3.0}, {39.0, 31.0}, 10'000, inside);
        CHECK(inside.held > 9'500);
        counted on_the_row;
        walk(*model, l, {0.0, 20.0}, {40.0, 20.0}, 10'000, on_the_row);
        CHECK(on_the_row.held > 9'500);
    }
}

} // namespace nearest_test
