// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "rounds.hpp"

namespace phantom_models_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("the order of the tactors in the file does not matter, for any model")
{
    generator g(5);
    for (unsigned round = 0; round < 300; ++round) {
        const array a = some_array(g, round % kinds_of_array);
        const auto [b, now] = shuffled(g, a);
        const layout l(a);
        const layout m(b);
        for (const auto k : {phantom_kind::inverse_distance, phantom_kind::barycentric, phantom_kind::linear,
                             phantom_kind::log, phantom_kind::gaussian})
            for (unsigned i = 0; i < 10; ++i) {
                const point p = some_point(g, l);
                std::vector<drive> moved = weights(l, k, p);
                for (drive& x : moved)
                    x.tactor = now[x.tactor];
                std::sort(moved.begin(), moved.end(), [](auto& x, auto& y) { return x.tactor < y.tactor; });
                const std::vector<drive> there = weights(m, k, p);
                CAPTURE(round);
                REQUIRE(there.size() == moved.size());
                for (std::size_t j = 0; j < there.size(); ++j) {
                    REQUIRE(there[j].tactor == moved[j].tactor);
                    REQUIRE(there[j].amplitude == doctest::Approx(moved[j].amplitude).epsilon(1e-12));
                }
            }
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
    for (const auto k : {phantom_kind::inverse_distance, phantom_kind::barycentric, phantom_kind::linear,
                         phantom_kind::log, phantom_kind::gaussian}) {
        CHECK(weights(l, k, {7.0, 9.0}, 0.0).empty());
        CHECK_THROWS_AS(weights(l, k, {7.0, 9.0}, -1.0), error);
        CHECK_THROWS_AS(weights(l, k, {7.0, 9.0}, not_a_number), error);
        CHECK_THROWS_AS(weights(l, k, {not_a_number, 9.0}), error);
        // Outside: the nearest point of the hull.
        CHECK(weights(l, k, {7.0, -1e9}) == weights(l, k, {7.0, 0.0}));
    }
}

TEST_CASE("phantom models by name")
{
    for (const auto k : {phantom_kind::inverse_distance, phantom_kind::barycentric, phantom_kind::linear,
                         phantom_kind::log, phantom_kind::gaussian}) {
        CHECK(from_string<phantom_kind>(to_string(k)) == k);
        CHECK(make_phantom(k, layout(preset_array("palm-2x4")))->name() == to_string(k));
    }
    CHECK_THROWS_WITH_AS(from_string<phantom_kind>("cubic"), doctest::Contains("barycentric"), error);
}

} // namespace phantom_models_test
