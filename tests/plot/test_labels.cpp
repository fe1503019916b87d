// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "plot/draw/array_frame.hpp"
#include "plot/paint/canvas.hpp"

namespace labels_test {

using namespace tactor::plot;

namespace {

box label_box(spot baseline, const std::string& text, double size)
{
    return {baseline.x, baseline.y - cap_height(size), text_width(text, size), cap_height(size)};
}

bool overlap(box a, box b)
{
    return std::min(a.right(), b.right()) > std::max(a.x, b.x) &&
           std::min(a.bottom(), b.bottom()) > std::max(a.y, b.y);
}

} // namespace

TEST_CASE("labels of one place do not cover each other, nor the place")
{
    label_placer p({0.0, 0.0, 200.0, 200.0});
    p.block_disc({100.0, 100.0}, 5.0);
    std::vector<box> boxes{{95.0, 95.0, 10.0, 10.0}};
    for (const std::string text : {"start 1", "end 1", "ch 4", "start 2"}) {
        const box b = label_box(p.place(text, 6.0, {{100.0, 100.0}}, 0, 6.0, 20.0).value(), text, 6.0);
        for (const box& other : boxes)
            CHECK_FALSE(overlap(b, other));
        boxes.push_back(b);
    }
}

TEST_CASE("labels stay in the area, even in each corner")
{
    for (const spot at : {spot{2.0, 2.0}, spot{98.0, 2.0}, spot{2.0, 98.0}, spot{98.0, 98.0}}) {
        label_placer p({0.0, 0.0, 100.0, 100.0});
        const box b = label_box(p.place("ch 12", 6.0, {at}, 0, 3.0, 12.0).value(), "ch 12", 6.0);
        CHECK(b.x >= 0.0);
        CHECK(b.y >= 0.0);
        CHECK(b.right() <= 100.0);
        CHECK(b.bottom() <= 100.0);
    }
}

TEST_CASE("a label of one of many sites is nearest to that one, or left out")
{
    std::vector<spot> sites;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            sites.push_back({30.0 + 18.0 * column, 30.0 + 18.0 * row});
    label_placer p({0.0, 0.0, 120.0, 120.0});
    for (const spot s : sites)
        p.block_disc(s, 4.0);
    std::vector<box> boxes;
    for (std::size_t i = 0; i < sites.size(); ++i) {
        const auto place = p.place("88", 5.2, sites, i, 5.2, 3.0);
        REQUIRE(place);
        const box b = label_box(*place, "88", 5.2);
        const auto distance = [&](spot s) {
            return std::hypot(std::max({b.x - s.x, s.x - b.right(), 0.0}),
                              std::max({b.y - s.y, s.y - b.bottom(), 0.0}));
        };
        for (std::size_t k = 0; k < sites.size(); ++k) {
            CHECK(distance(sites[k]) >= (k == i ? 4.0 : 1.2 * distance(sites[i])));
            CHECK_FALSE(overlap(b, {sites[k].x - 4.0, sites[k].y - 4.0, 8.0, 8.0}));
        }
        for (const box& other : boxes)
            CHECK_FALSE(overlap(b, other));
        boxes.push_back(b);
    }
    CHECK_FALSE(p.place("a long name", 6.0, sites, 5, 5.2, 3.0));
}

TEST_CASE("a label is left out rather than put on another")
{
    label_placer p({0.0, 0.0, 100.0, 100.0});
    CHECK(p.place("1", 6.0, {{50.0, 50.0}}, 0, 3.0, 20.0));
    p.block({0.0, 0.0, 100.0, 100.0});
    CHECK_FALSE(p.place("2", 6.0, {{50.0, 50.0}}, 0, 3.0, 20.0));
}

TEST_CASE("labels avoid a line")
{
    label_placer p({0.0, 0.0, 100.0, 100.0});
    p.avoid_line({{0.0, 56.0}, {100.0, 56.0}}); // where the label would go first
    const box b = label_box(p.place("end", 6.0, {{50.0, 48.0}}, 0, 3.0, 12.0).value(), "end", 6.0);
    CHECK_FALSE(overlap(b, {0.0, 55.0, 100.0, 2.0}));
}

} // namespace labels_test
