// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace axes_test {

using namespace tactor::plot;

namespace {

// Returns labels of ticks, left to right, as boxes on the page.
struct label {
    double from;
    double to;
    std::string text;
};

std::vector<label> tick_labels(const canvas& c)
{
    std::vector<label> all;
    for (const canvas::element& e : c.elements)
        if (const auto* t = std::get_if<item::text>(&e); t != nullptr && t->m.kind == "tick-label") {
            const double half = text_width(t->string, t->s.size) / 2.0;
            all.push_back({t->at.x - half, t->at.x + half, t->string});
        }
    return all;
}

double distance_to(const std::vector<spot>& line, spot p)
{
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double dx = line[i].x - line[i - 1].x;
        const double dy = line[i].y - line[i - 1].y;
        const double square = dx * dx + dy * dy;
        const double t =
            square > 0.0
                ? std::clamp(((p.x - line[i - 1].x) * dx + (p.y - line[i - 1].y) * dy) / square, 0.0, 1.0)
                : 0.0;
        least = std::min(least, std::hypot(p.x - line[i - 1].x - t * dx, p.y - line[i - 1].y - t * dy));
    }
    return least;
}

std::vector<spot> wander(std::mt19937_64& random, int n)
{
    std::normal_distribution<double> step(0.0, 8.0);
    std::vector<spot> line{{50.0, 50.0}};
    for (int i = 1; i < n; ++i)
        line.push_back({line.back().x + step(random), line.back().y + step(random)});
    return line;
}

} // namespace

TEST_CASE("ticks are round numbers inside the range, at most as many as asked for")
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> exponent(-6.0, 6.0);
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    for (int i = 0; i < 5000; ++i) {
        const double span = std::pow(10.0, exponent(random));
        const double lo = part(random) * span;
        const std::size_t most = 2 + static_cast<std::size_t>(i % 10);
        const ticks t = nice_ticks(lo, lo + span, most);
        CHECK(t.at.size() <= most);
        CHECK(!t.at.empty());
        const double mantissa = t.step / std::pow(10.0, std::floor(std::log10(t.step) + 1e-9));
        CHECK((std::abs(mantissa - 1.0) < 1e-6 || std::abs(mantissa - 2.0) < 1e-6 ||
               std::abs(mantissa - 5.0) < 1e-6));
        for (const double v : t.at) {
            CHECK(v >= lo - 1e-6 * span);
            CHECK(v <= lo + span + 1e-6 * span);
            CHECK(std::abs(v / t.step - std::round(v / t.step)) < 1e-6);
        }
    }
}

TEST_CASE("an empty range, and a non-number, have one tick")
{
    CHECK(nice_ticks(2.0, 2.0, 5).at.size() == 1);
    CHECK(nice_ticks(0.0, std::numeric_limits<double>::infinity(), 5).at.size() == 1);
    CHECK(nice_ticks(0.0, 1.0, 0).at.size() == 1);
}

TEST_CASE("labels have as many decimals as the step")
{
    const ticks t = nice_ticks(0.0, 0.35, 8);
    CHECK(t.step == doctest::Approx(0.05));
    CHECK(t.label(0.1) == "0.10");
    CHECK(t.label(-1e-18) == "0.00");
    CHECK(nice_ticks(0.0, 3600.0, 8).label(500.0) == "500");
}

TEST_CASE("labels along an axis do not touch, and all differ")
{
    for (double end = 0.001; end < 100000.0; end *= 1.37)
        for (const double width : {40.0, 120.0, 180.0, 500.0}) {
            canvas c;
            draw_horizontal_axis(c, {0.0, end, 50.0, 50.0 + width}, 10.0, 0.0, "time (s)");
            const std::vector<label> labels = tick_labels(c);
            std::set<std::string> texts;
            for (std::size_t i = 0; i < labels.size(); ++i) {
                texts.insert(labels[i].text);
                if (i > 0)
                    CHECK(labels[i].from > labels[i - 1].to);
            }
            CHECK(texts.size() == labels.size());
            CHECK(!labels.empty());
        }
}

TEST_CASE("a chart of a million values costs no more than its width")
{
    chart ch;
    ch.where = {0.0, 0.0, 200.0, 100.0};
    ch.x_to = 1e6;
    ch.y_to = 2.0;
    ch.lines = {{"noise", {}, {.stroke = blue}}};
    for (int i = 0; i < 1000000; ++i)
        ch.lines[0].values.push_back({static_cast<double>(i), 1.0 + std::sin(i * 0.7)});
    canvas c;
    draw_chart(c, ch);
    std::size_t points = 0;
    for (const canvas::element& e : c.elements)
        if (const auto* p = std::get_if<item::poly>(&e))
            points += p->points.size();
    CHECK(points > 100);
    CHECK(points < 5000);
}

TEST_CASE("a chart keeps its lines inside, its extremes, and breaks lines where a value is missing")
{
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    chart ch;
    ch.where = {10.0, 20.0, 150.0, 90.0};
    ch.x_to = 4.0;
    ch.y_to = 2.0;
    ch.lines = {{"speed", {{0.0, 0.0}, {1.0, 2.0}, {2.0, none}, {3.0, 1.0}, {4.0, 50.0}}, {.stroke = blue}}};
    canvas c;
    const box inside = draw_chart(c, ch);
    std::vector<const item::poly*> curves;
    for (const canvas::element& e : c.elements)
        if (const auto* p = std::get_if<item::poly>(&e))
            curves.push_back(p);
    REQUIRE(curves.size() == 2);
    CHECK(curves[0]->points.size() == 2);
    CHECK(curves[0]->points[1].x == doctest::Approx(inside.x + inside.width / 4.0));
    CHECK(curves[0]->points[1].y == doctest::Approx(inside.y));
    for (const item::poly* p : curves)
        for (const spot& s : p->points) {
            CHECK(s.y >= inside.y - 1e-9);
            CHECK(s.y <= inside.bottom() + 1e-9);
        }
    CHECK(inside.bottom() < ch.where.bottom());
    CHECK(inside.x > ch.where.x);
}

TEST_CASE("a clipped line is inside the box, and keeps its part inside")
{
    std::mt19937_64 random(3);
    const box b{20.0, 30.0, 60.0, 40.0};
    for (int i = 0; i < 300; ++i) {
        const std::vector<spot> line = wander(random, 40);
        const auto parts = clip(line, b);
        for (const auto& part : parts) {
            CHECK(part.size() >= 2);
            for (const spot& s : part) {
                CHECK(s.x >= b.x - 1e-9);
                CHECK(s.x <= b.right() + 1e-9);
                CHECK(s.y >= b.y - 1e-9);
                CHECK(s.y <= b.bottom() + 1e-9);
            }
        }
        for (const spot& s : line)
            if (s.x > b.x && s.x < b.right() && s.y > b.y && s.y < b.bottom()) {
                const bool kept = std::any_of(parts.begin(), parts.end(),
                                              [&](const auto& part) { return distance_to(part, s) < 1e-9; });
                CHECK(kept);
            }
    }
}

TEST_CASE("logarithmic ticks are at round numbers, with fewer of them over more decades")
{
    const auto labels = [](double lo, double hi) {
        const ticks t = log_ticks(std::log10(lo), std::log10(hi), 7);
        std::vector<std::string> all;
        for (const double v : t.at)
            all.push_back(t.label(v));
        return all;
    };
    CHECK(labels(0.9, 60.0) == std::vector<std::string>{"1", "2", "5", "10", "20", "50"});
    CHECK(labels(0.05, 2000.0) == std::vector<std::string>{"0.1", "1", "10", "100", "1000"});
    CHECK(labels(2.0, 6.0) == std::vector<std::string>{"2", "3", "4", "5", "6"});
}

TEST_CASE("a line that only passes through is cut at both sides")
{
    const auto parts = clip({{-10.0, 5.0}, {30.0, 5.0}}, {0.0, 0.0, 20.0, 10.0});
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].front().x == doctest::Approx(0.0));
    CHECK(parts[0].back().x == doctest::Approx(20.0));
    CHECK(clip({{-10.0, 25.0}, {30.0, 25.0}}, {0.0, 0.0, 20.0, 10.0}).empty());
    CHECK(clip({}, {0.0, 0.0, 1.0, 1.0}).empty());
}

TEST_CASE("a simplified line stays within the tolerance, between the same ends")
{
    std::mt19937_64 random(5);
    for (int i = 0; i < 200; ++i) {
        const std::vector<spot> line = wander(random, 200);
        const double tolerance = 0.5 + i % 7;
        const std::vector<spot> fewer = simplify(line, tolerance);
        CHECK(fewer.size() <= line.size());
        CHECK(fewer.front().x == line.front().x);
        CHECK(fewer.back().y == line.back().y);
        for (const spot& s : line)
            CHECK(distance_to(fewer, s) <= tolerance + 1e-9);
    }
    std::vector<spot> straight;
    for (int i = 0; i <= 1000; ++i)
        straight.push_back({i * 0.1, i * 0.2});
    CHECK(simplify(straight, 0.01).size() == 2);
}

} // namespace axes_test
