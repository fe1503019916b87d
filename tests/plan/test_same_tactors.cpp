// SPDX-License-Identifier: MIT
// A reader that follows a target gets the same bits as one that asks anew, and mostly need not ask.
#include <vector>

#include <doctest/doctest.h>

#include <tactor/phantom.hpp>

#include "arrays.hpp"
#include "plan/phantom/same_tactors.hpp"
#include "rounds.hpp"

namespace same_tactors_test {

using namespace tactor;
using namespace tactor::test;

namespace {

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
            detail::look_around(three, l, p, seen);
            continue;
        }
        ++count.held;
        count.on_segments += seen.on_segment ? 1 : 0;
        detail::drives_of_same(three, l, seen, p, 0.7, drives);
        REQUIRE(drives == anew);
    }
}

} // namespace

TEST_CASE("in arrays of all kinds, a target that is followed has the same drives to the bit")
{
    generator g(2016);
    counted all;
    for (int round = 0; round < rounds(900); ++round) {
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
        for (int round = 0; round < rounds(900); ++round) {
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

} // namespace same_tactors_test
