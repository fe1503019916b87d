// SPDX-License-Identifier: MIT
#include <numeric>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/array.hpp>

#include "plot/draw/timeline.hpp"

namespace rows_test {

using namespace tactor::plot;

namespace {

// Makes the rows of so many tactors in a line, all of which play.
lanes make_rows(unsigned n, double space)
{
    tactor::array a;
    for (unsigned i = 0; i < n; ++i)
        a.tactors.push_back({.position = {10.0 * i, 0.0}, .channel = i});
    std::vector<unsigned> playing(n);
    std::iota(playing.begin(), playing.end(), 0U);
    lanes l = make_lanes(a, playing, space);
    l.fit(space);
    return l;
}

std::size_t labels(const lanes& l, std::string& said)
{
    canvas c;
    said = draw_lane_labels(c, l, 100.0, 0.0);
    return c.elements.size();
}

} // namespace

TEST_CASE("rows take no more than their space, and each has its number or is listed as without")
{
    std::string said;
    for (const double space : {120.0, 270.0, 1000.0})
        for (const unsigned n : {1U, 9U, 40U, 64U, 65U, 82U, 83U, 120U, 400U}) {
            const lanes l = make_rows(n, space);
            CHECK(l.total_height() <= space + 1e-9);
            const std::size_t shown = labels(l, said);
            CHECK(said.empty() == (shown == l.rows.size()));
        }
    CHECK(labels(make_rows(82, 1000.0), said) == 82);
    CHECK(labels(make_rows(83, 1000.0), said) == 42);
    CHECK(said == "one row in 2 has its number");
}

} // namespace rows_test
