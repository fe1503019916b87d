// SPDX-License-Identifier: MIT
// Panels of bars and matrices: which texts they show, and where.
#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <doctest/doctest.h>

#include "plot/draw/axes.hpp"
#include "plot/figure.hpp"
#include "plot/paint/canvas.hpp"

namespace panels_test {

using namespace tactor::plot;

namespace {

std::vector<item::text> list_texts(const canvas& c, const std::string& kind)
{
    std::vector<item::text> all;
    for (const canvas::element& e : c.elements)
        if (const auto* t = std::get_if<item::text>(&e); t != nullptr && t->m.kind == kind)
            all.push_back(*t);
    return all;
}

// Returns the number of different texts of a kind.
std::size_t count_texts(const canvas& c, const std::string& kind)
{
    std::set<std::string> all;
    for (const item::text& t : list_texts(c, kind))
        all.insert(t.string);
    return all.size();
}

// Returns the place of the first or last element with a text of a kind.
std::size_t find_text(const canvas& c, const std::string& kind, bool last)
{
    std::size_t found = c.elements.size();
    for (std::size_t i = 0; i < c.elements.size(); ++i)
        if (const auto* t = std::get_if<item::text>(&c.elements[i]); t != nullptr && t->m.kind == kind)
            if (last || found == c.elements.size())
                found = i;
    REQUIRE(found < c.elements.size());
    return found;
}

panel_figure make_figure(double width_mm)
{
    panel_figure f;
    f.title = "study";
    f.width_mm = width_mm;
    f.across = "simulated";
    bar_panel p{"a run with a long name: constant error of speed by method (n = 24)",
                "constant error of speed (mm/s)", -0.1, 0.1};
    p.series.emplace_back();
    for (const char* method : {"continuous-150-hz", "continuous-250-hz", "continuous-200-hz"})
        for (const char* motion : {":from-left-to-right", ":from-left-to-centre"}) {
            p.groups.push_back(std::string(method) + motion);
            p.series[0].bars.push_back({0.05});
        }
    f.bars = {p};
    f.curves = {{"a", {"x"}, {"curve y (mm)", -0.1, 0.1}}};
    f.matrices = {{"which: answers with a",
                   "played",
                   "answered",
                   {"from-left-to-right", "from-left-to-centre"},
                   {{3, 1}, {0, 4}}}};
    return f;
}

} // namespace

TEST_CASE("names of bars, rows and columns that differ are drawn differently in pictures of any width")
{
    for (const double width_mm : {60.0, 85.0, 170.0}) {
        const canvas c = draw_panels(make_figure(width_mm));
        CHECK(count_texts(c, "group") == 6);
        CHECK(count_texts(c, "row") == 2);
        CHECK(count_texts(c, "column") == 2);
        for (const item::text& t : list_texts(c, "row"))
            CHECK(t.at.x - text_width(t.string, t.s.size) > 0.0);
    }
}

TEST_CASE("the title of an axis ends with its unit, and is left of the labels")
{
    const canvas c = draw_panels(make_figure(60.0));
    double left = c.width; // of the labels of the panel that is drawn now
    std::size_t checked = 0;
    for (const canvas::element& e : c.elements) {
        const auto* t = std::get_if<item::text>(&e);
        if (t == nullptr)
            continue;
        if (t->m.kind == "tick-label" && t->s.anchor == align::end)
            left = std::min(left, t->at.x - text_width(t->string, t->s.size));
        constexpr double descent = 0.24;
        if (t->m.kind == "axis-title" && t->s.upwards && t->string.find('(') != std::string::npos) {
            CHECK(t->at.x + descent * t->s.size < left);
            CHECK(t->at.x - cap_height(t->s.size) >= 0.0);
            CHECK(t->string.ends_with(")"));
            left = c.width;
            ++checked;
        }
    }
    CHECK(checked == 2);
    CHECK(list_texts(c, "panel-title").front().string.ends_with(" (n = 24)"));
}

TEST_CASE("text across a matrix covers no number")
{
    panel_figure f = make_figure(85.0);
    f.bars.clear();
    f.curves.clear();
    const canvas c = draw_panels(f);
    CHECK(list_texts(c, "count").size() == 3);
    CHECK(find_text(c, "across", true) < find_text(c, "count", false));
}

} // namespace panels_test
