// SPDX-License-Identifier: MIT
#include <numeric>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/array.hpp>

#include "plot/draw/lanes.hpp"
#include "plot/draw/notes.hpp"
#include "plot/paint/text.hpp"

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
    return make_lanes(a, playing, space);
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
            CHECK(l.all_height <= space + 1e-9);
            CHECK(l.rows.back().top + l.rows.back().height == doctest::Approx(l.all_height));
            const std::size_t shown = labels(l, said);
            CHECK(said.empty() == (shown == l.rows.size()));
        }
    CHECK(labels(make_rows(82, 1000.0), said) == 82);
    CHECK(labels(make_rows(83, 1000.0), said) == 42);
    CHECK(said == "one row in 2 has its number");
}

TEST_CASE("rows of many levels leave rows of one the height of a number")
{
    lanes l = make_rows(40, 1000.0);
    for (std::size_t i = 0; i < l.rows.size(); i += 4)
        l.rows[i].levels = 10; // 130 in all
    REQUIRE(l.fit(350.0));
    CHECK(l.all_height == doctest::Approx(350.0));
    std::string said;
    CHECK(labels(l, said) == 40);
    CHECK(l.rows[0].height == doctest::Approx(10.0 * l.height));
    CHECK(l.rows[1].height > 2.0 * l.height);
    CHECK_FALSE(l.fit(300.0)); // levels too low to be visible
}

TEST_CASE("a note too wide for a line continues in the next, one too many is shortened")
{
    const std::string wide = "no space for the numbers of tactors 3, 12, 15, 20, 26, 34, 41, 52";
    const auto lines = note_lines({"squares: ends", "", wide, "one burst in 4"}, 120.0, 4);
    REQUIRE(lines.size() == 4);
    CHECK(lines[0] == "squares: ends;");
    CHECK(lines[1] + " " + lines[2] + " " + lines[3] == wide + "; one burst in 4");
    for (const std::string& l : lines)
        CHECK(text_width(l, 6.0) <= 120.0);
    CHECK(note_lines({"squares: ends", wide}, 120.0, 2)[1].ends_with("\xE2\x80\xA6"));
    CHECK(note_lines({"a", "b"}, 120.0, 2) == std::vector<std::string>{"a; b"});
}

} // namespace rows_test
