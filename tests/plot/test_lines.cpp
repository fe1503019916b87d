// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "plot/draw/axes.hpp"

namespace lines_test {

using namespace tactor::plot;

namespace {

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

} // namespace lines_test
