// SPDX-License-Identifier: MIT
// Phantoms: Eqs. (8) and (9), and the other models.
#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "rounds.hpp"

namespace phantom_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE(
    "inverse distance keeps Eqs. (8) and (9), at most three tactors, and a triangle that holds the point")
{
    generator g(1);
    for (unsigned round = 0; round < 600; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        const auto model = make_phantom(phantom_kind::inverse_distance, l);
        std::vector<drive> d;
        for (unsigned i = 0; i < 30; ++i) {
            const point p = some_point(g, l);
            const double a_v = between(g, 0.01, 3.0);
            model->weights(p, a_v, d);
            CAPTURE(round);
            CAPTURE(p.x_mm);
            CAPTURE(p.y_mm);
            REQUIRE(!d.empty());
            REQUIRE(d.size() <= 3);
            REQUIRE(std::is_sorted(d.begin(), d.end(), [](auto& x, auto& y) { return x.tactor < y.tactor; }));
            REQUIRE(std::abs(energy(d) / (a_v * a_v) - 1.0) < 1e-12);
            const auto moment = [&](const drive& x) {
                return distance_mm(p, l.places()[x.tactor]) * x.amplitude * x.amplitude;
            };
            for (const drive& x : d)
                REQUIRE(moment(x) == doctest::Approx(moment(d[0])).epsilon(1e-10));
            const auto place = [&](std::size_t k) { return l.places()[d[k].tactor]; };
            if (d.size() == 1)
                REQUIRE(distance_mm(place(0), p) <= same_place_mm);
            else if (d.size() == 2)
                REQUIRE(off_segment(place(0), place(1), p) <= same_place_mm);
            else
                REQUIRE(in_triangle(place(0), place(1), place(2), p));
        }
    }
}

TEST_CASE("a point's drives do not depend on the points before it, even near edges, diagonals and tactors")
{
    generator g(7);
    std::vector<drive> d;
    std::vector<drive> alone;
    for (unsigned round = 0; round < 40; ++round) {
        CAPTURE(round);
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        const auto kind = static_cast<phantom_kind>(round % 4);
        const auto model = make_phantom(kind, l);
        point p = some_point(g, l);
        for (unsigned i = 0; i < 60; ++i) {
            // Small steps stay in a face, the smallest ones in its rim; others lead to any face.
            const double step = std::pow(10.0, between(g, -8.0, 0.0)) * l.pitch_mm();
            p = i % 4 == 0 ? some_point(g, l)
                           : point{p.x_mm + between(g, -step, step), p.y_mm + between(g, -step, step)};
            model->weights(p, 1.0, d);
            const layout fresh(a);
            make_phantom(kind, fresh)->weights(p, 1.0, alone);
            CAPTURE(p.x_mm);
            CAPTURE(p.y_mm);
            REQUIRE(d == alone);
            REQUIRE(l.contains(p) == fresh.contains(p));
        }
    }
}

TEST_CASE("inverse distance chooses tactors by the rules, by brute force")
{
    generator g(2);
    for (unsigned round = 0; round < 500; ++round) {
        const unsigned kind = std::array<unsigned, 6>{0U, 1U, 2U, 3U, 4U, 8U}[round % 6];
        // The oracle takes indices for ranks: by row, then by column.
        array a = some_array(g, kind);
        std::stable_sort(a.tactors.begin(), a.tactors.end(), [](const auto& x, const auto& y) {
            return x.position.y_mm < y.position.y_mm - same_place_mm ||
                   (x.position.y_mm < y.position.y_mm + same_place_mm && x.position.x_mm < y.position.x_mm);
        });
        const layout l(a);
        const auto model = make_phantom(phantom_kind::inverse_distance, l);
        std::vector<drive> d;
        for (unsigned i = 0; i < 30; ++i) {
            const point p = some_point(g, l);
            model->weights(p, 1.0, d);
            CAPTURE(kind);
            CAPTURE(round);
            CAPTURE(p.x_mm);
            CAPTURE(p.y_mm);
            REQUIRE(list_tactors(d) == expected_tactors(l, p));
        }
    }
}

TEST_CASE("edges and diagonals play two tactors, the shortest segment first and then the lowest")
{
    const layout l(make_grid("g", 3, 3, 20.0, 40.0));
    const auto at = [&](double x, double y) {
        return list_tactors(weights(l, phantom_kind::inverse_distance, {x, y}));
    };
    CHECK(at(20.0, 40.0) == std::vector<unsigned>{4});
    CHECK(at(20.0 + 0.9e-6, 40.0) == std::vector<unsigned>{4});
    CHECK(at(5.0, 0.0) == std::vector<unsigned>{0, 1});
    CHECK(at(5.0, 10.0) == std::vector<unsigned>{0, 4});
    CHECK(at(15.0, 10.0) == std::vector<unsigned>{1, 3});
    CHECK(at(10.0, 20.0) == std::vector<unsigned>{0, 4});
    CHECK(at(5.0, 10.0 + 0.9e-6) == std::vector<unsigned>{0, 4});
    CHECK(at(5.0, 10.01).size() == 3);

    // Half-way up to the next tactor: Eq. (2).
    const auto d = weights(l, phantom_kind::inverse_distance, {5.0, 0.0}, 2.0);
    CHECK(d[0].amplitude == doctest::Approx(2.0 * std::sqrt(0.75)).epsilon(1e-14));
    CHECK(d[1].amplitude == doctest::Approx(2.0 * std::sqrt(0.25)).epsilon(1e-14));
}

TEST_CASE("the energy centroid of inverse distance misses the point by up to 4.7 mm on the paper's array")
{
    const layout l(preset_array("palm-3x3"));
    const auto model = make_phantom(phantom_kind::inverse_distance, l);
    std::vector<drive> d;
    double worst = 0.0;
    for (double x = 0.05; x < 20.0; x += 0.1)
        for (double y = 0.03; y < 20.0; y += 0.1) {
            model->weights({x, y}, 1.0, d);
            worst = std::max(worst, distance_mm({x, y}, energy_centroid(l, d)));
        }
    CHECK(worst == doctest::Approx(4.7).epsilon(0.02));
}

TEST_CASE("ties in distance go to the lowest tactor by row and column, within a nanometre")
{
    for (const double noise : {0.0, 3e-7}) {
        array a = preset_array("palm-3x3");
        for (std::size_t i = 0; i < 9; ++i)
            a.tactors[i].position.y_mm += i % 2 == 0 ? noise : 0.0;
        const layout l(a);
        const auto at = [&](double x, double y) {
            return list_tactors(weights(l, phantom_kind::inverse_distance, {x, y}));
        };
        CAPTURE(noise);
        CHECK(at(10.0, 3.0) == std::vector<unsigned>{0, 1, 3});
        CHECK(at(3.0, 10.0) == std::vector<unsigned>{0, 1, 3});
        CHECK(at(10.0, 17.0) == std::vector<unsigned>{0, 3, 4});
        CHECK(at(17.0, 10.0) == std::vector<unsigned>{0, 1, 4});
        CHECK(at(10.0, 10.0) == std::vector<unsigned>{0, 4});
        CHECK(at(30.0, 30.0) == std::vector<unsigned>{4, 8});
    }
}

TEST_CASE("the order of the tactors in the file does not matter, for any model")
{
    generator g(5);
    generator h(12);
    for (unsigned round = 0; round < 300; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const auto [b, now] = shuffled(g, a);
        const layout l(a);
        const layout m(b);
        const auto check_same = [&, &now = now](point p, phantom_kind k, faces_kind faces) {
            std::vector<drive> moved = weights(l, k, p, 1.0, faces);
            for (drive& x : moved)
                x.tactor = now[x.tactor];
            std::sort(moved.begin(), moved.end(), [](auto& x, auto& y) { return x.tactor < y.tactor; });
            const std::vector<drive> there = weights(m, k, p, 1.0, faces);
            REQUIRE(there.size() == moved.size());
            for (std::size_t j = 0; j < there.size(); ++j) {
                REQUIRE(there[j].tactor == moved[j].tactor);
                REQUIRE(there[j].amplitude == doctest::Approx(moved[j].amplitude).epsilon(1e-12));
            }
        };
        CAPTURE(round);
        for (const phantom_kind k : all_values<phantom_kind>())
            for (unsigned i = 0; i < 10; ++i)
                check_same(some_point(g, l), k, faces_kind::delaunay);
        for (unsigned i = 0; i < 20; ++i)
            check_same(some_point(h, l), phantom_kind::inverse_distance, faces_kind::nearest);
    }
}

TEST_CASE("barycentric keeps the energy and its centroid is the point")
{
    generator g(6);
    for (unsigned round = 0; round < 400; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        for (unsigned i = 0; i < 20; ++i) {
            const point p = some_point(g, l);
            const auto d = weights(l, phantom_kind::barycentric, p, 0.5);
            CAPTURE(round);
            REQUIRE(d.size() <= 3);
            REQUIRE(energy(d) == doctest::Approx(0.25).epsilon(1e-12));
            REQUIRE(distance_mm(energy_centroid(l, d), p) < 2e-6);
        }
    }
}

TEST_CASE("barycentric is continuous: a small step changes every tactor's energy little")
{
    generator g(7);
    for (const array& a : {preset_array("palm-3x3"), staggered(4, 4, 20.0), make_ring(12, 30.0, false),
                           make_grid("g", 3, 3, 20.0, 40.0), cloud(g, 25)}) {
        const layout l(a);
        const auto model = make_phantom(phantom_kind::barycentric, l);
        for (int walk = 0; walk < rounds(20); ++walk) {
            const point from = some_point(g, l);
            const point to = some_point(g, l);
            std::vector<double> before;
            std::vector<drive> d;
            for (unsigned i = 0; i <= 5000; ++i) {
                const double u = i / 5000.0;
                model->weights({from.x_mm + u * (to.x_mm - from.x_mm), from.y_mm + u * (to.y_mm - from.y_mm)},
                               1.0, d);
                std::vector<double> now(l.places().size(), 0.0);
                for (const drive& x : d)
                    now[x.tactor] = x.amplitude * x.amplitude;
                for (std::size_t t = 0; t < before.size(); ++t)
                    REQUIRE(std::abs(now[t] - before[t]) < 0.02 * distance_mm(from, to) / 10.0 + 1e-5);
                before = now;
            }
        }
    }
}

TEST_CASE("linear and log use the barycentric triangle")
{
    generator g(8);
    for (unsigned round = 0; round < 200; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        const point p = some_point(g, l);
        const auto b = weights(l, phantom_kind::barycentric, p);
        const auto linear = weights(l, phantom_kind::linear, p, 0.7);
        const auto log = weights(l, phantom_kind::log, p, 0.7);
        REQUIRE(linear.size() == b.size());
        REQUIRE(log.size() == b.size());
        for (std::size_t i = 0; i < b.size(); ++i) {
            const double share = b[i].amplitude * b[i].amplitude;
            REQUIRE(linear[i].tactor == b[i].tactor);
            REQUIRE(linear[i].amplitude == doctest::Approx(0.7 * share).epsilon(1e-9));
            REQUIRE(log[i].amplitude == doctest::Approx(0.7 * std::log2(1.0 + share)).epsilon(1e-9));
        }
    }
}

TEST_CASE("a face of many tactors is split as a fan from its lowest one")
{
    const layout l(preset_array("palm-3x3"));
    // Cell 0, 1, 4, 3: the diagonal goes from 0 to 4.
    CHECK(list_tactors(weights(l, phantom_kind::barycentric, {15.0, 5.0})) == std::vector<unsigned>{0, 1, 4});
    CHECK(list_tactors(weights(l, phantom_kind::barycentric, {5.0, 15.0})) == std::vector<unsigned>{0, 3, 4});
    CHECK(list_tactors(weights(l, phantom_kind::barycentric, {10.0, 10.0})) == std::vector<unsigned>{0, 4});
}

TEST_CASE("gaussian weighs all near tactors by distance, keeps the energy, and drops the weak ones")
{
    generator g(9);
    for (unsigned round = 0; round < 400; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const layout l(a);
        const point p = some_point(g, l);
        const auto d = weights(l, phantom_kind::gaussian, p, 0.8);
        REQUIRE(energy(d) == doctest::Approx(0.64).epsilon(1e-12));
        if (a.tactors.size() == 1)
            continue;
        const double sigma = 0.6 * l.pitch_mm();
        std::vector<double> weight;
        for (const point& t : l.places())
            weight.push_back(-distance_mm(t, p) * distance_mm(t, p) / (2.0 * sigma * sigma));
        const double largest = *std::max_element(weight.begin(), weight.end());
        double sum = 0.0;
        for (double& w : weight) {
            w = std::exp(w - largest);
            w = w < 0.01 ? 0.0 : w;
            sum += w * w;
        }
        std::size_t playing = 0;
        for (const double w : weight)
            playing += w > 0.0 ? 1 : 0;
        REQUIRE(d.size() == playing);
        for (const drive& x : d)
            REQUIRE(x.amplitude == doctest::Approx(0.8 * weight[x.tactor] / std::sqrt(sum)).epsilon(1e-9));
    }
}

TEST_CASE("no intensity gives no drives, and non-numbers are refused")
{
    const layout l(preset_array("palm-3x3"));
    for (const phantom_kind k : all_values<phantom_kind>()) {
        CHECK(weights(l, k, {7.0, 9.0}, 0.0).empty());
        CHECK_THROWS_AS(weights(l, k, {7.0, 9.0}, -1.0), error);
        CHECK_THROWS_AS(weights(l, k, {7.0, 9.0}, not_a_number), error);
        CHECK_THROWS_AS(weights(l, k, {not_a_number, 9.0}), error);
        // Outside: the nearest point of the hull.
        CHECK(weights(l, k, {7.0, -1e9}) == weights(l, k, {7.0, 0.0}));
    }
}

TEST_CASE("phantom models have the names of their kinds")
{
    for (const phantom_kind k : all_values<phantom_kind>())
        CHECK(make_phantom(k, layout(preset_array("palm-2x4")))->name() == to_string(k));
}

} // namespace phantom_test
