// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "arrays.hpp"
#include "core/distance.hpp"
#include "plan/faces/box_index.hpp"

namespace box_index_test {

using namespace tactor;
using namespace tactor::test;
using detail::box;

namespace {

double distance_to(const box& b, point p)
{
    return detail::length_mm(
        p, {std::clamp(p.x_mm, b.low.x_mm, b.high.x_mm), std::clamp(p.y_mm, b.low.y_mm, b.high.y_mm)});
}

} // namespace

TEST_CASE("the index finds the same boxes as a search of all, on a grid, long, far apart or single")
{
    generator g(23);
    for (unsigned round = 0; round < 400; ++round) {
        const double longest = round % 4 == 0 ? 0.0 : round % 4 == 1 ? 20.0 : 2000.0;
        std::vector<box> boxes;
        for (unsigned n = pick(g, 1, 60), i = 0; i < n; ++i) {
            const point low{20.0 * pick(g, 0, 9) + (round % 8 == 7 && i % 2 == 0 ? 9e5 : 0.0),
                            20.0 * pick(g, 0, 9)};
            boxes.push_back(
                {low, {low.x_mm + between(g, 0.0, longest), low.y_mm + between(g, 0.0, longest)}});
        }
        const detail::box_index index(boxes);
        std::vector<unsigned> found;
        for (unsigned i = 0; i < 50; ++i) {
            const point p{10.0 * pick(g, 0, 40) - 100.0, between(g, -100.0, 300.0)};
            const double margin = 10.0 * pick(g, 0, 9);
            std::vector<unsigned> expected;
            unsigned nearest = 0;
            for (unsigned k = 0; k < boxes.size(); ++k) {
                const box& b = boxes[k];
                if (b.low.x_mm <= p.x_mm + margin && p.x_mm - margin <= b.high.x_mm &&
                    b.low.y_mm <= p.y_mm + margin && p.y_mm - margin <= b.high.y_mm)
                    expected.push_back(k);
                if (distance_to(b, p) < distance_to(boxes[nearest], p))
                    nearest = k;
            }
            index.near(p, margin, found);
            REQUIRE(found == expected);
            REQUIRE(index.nearest(p, [&](unsigned k) { return distance_to(boxes[k], p); }) == nearest);
        }
    }
}

} // namespace box_index_test
