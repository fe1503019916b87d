// SPDX-License-Identifier: MIT
// Drawings: their text, and the figures of paths against closed formulas. tests/study/check_r.py compares
// both tasks with R.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "study/data/drawing.hpp"
#include "study/results/drawings.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_drawings {
namespace {

using doctest::Approx;

drawing line(point from, point to, std::size_t points)
{
    drawing d;
    for (std::size_t i = 0; i < points; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(points - 1);
        d.push_back(
            {part, {from.x_mm + part * (to.x_mm - from.x_mm), from.y_mm + part * (to.y_mm - from.y_mm)}});
    }
    return d;
}

// Returns an arc around the origin, from an angle to another, rad.
drawing arc(double radius_mm, double from, double to)
{
    drawing d;
    constexpr int parts = 500;
    for (int i = 0; i <= parts; ++i) {
        const double angle = from + (to - from) * i / parts;
        d.push_back({0.001 * i, {radius_mm * std::cos(angle), radius_mm * std::sin(angle)}});
    }
    return d;
}

TEST_CASE("a drawing is read as it was written, and other texts are refused")
{
    const drawing d{{0.0, {1.0, -2.5}}, {0.016, {-0.01, 1e4}}, {3600.0, {0.0, 0.0}}};
    CHECK(to_text(d) == "0 1 -2.5;0.016 -0.01 10000;3600 0 0");
    CHECK(read_drawing(to_text(d)) == d);
    CHECK(to_text({{0.00049, {-0.001, 0.0049}}}) == "0 0 0");
    for (const char* text :
         {"", " ", ";", "0 1", "0 1 2 3", "0 1 2;", ";0 1 2", "0  1 2", "0 1 2; 1 1 2", "a 1 2", "0 nan 2",
          "0 inf 2", "-1 1 2", "0 10001 2", "3601 0 0", "1 0 0;0 1 1", "0,1 1 2", "0 1 2 ", "n/a"}) {
        CAPTURE(text);
        CHECK_FALSE(read_drawing(text));
    }
    std::string many = "0 1 2";
    for (std::size_t i = 1; i < most_drawn_points; ++i)
        many += ";0 1 2";
    CHECK(read_drawing(many)->size() == most_drawn_points);
    CHECK_FALSE(read_drawing(many + ";0 1 2"));
}

TEST_CASE("a drawing with too many points loses every second one, but neither end")
{
    for (const std::size_t n : {most_drawn_points, most_drawn_points + 1, 5 * most_drawn_points}) {
        const drawing d = thin_out(line({0, 0}, {100, 0}, n));
        CAPTURE(n);
        CHECK(is_drawing(d));
        CHECK(2 * d.size() >= most_drawn_points);
        CHECK((n > most_drawn_points || d.size() == n));
        CHECK(d.front().at == point{0, 0});
        CHECK(d.back().at.x_mm == Approx(100.0));
    }
}

TEST_CASE("a drawing is divided by length, not by points or time")
{
    const drawing uneven{{0.0, {0, 0}}, {0.0, {0, 0}}, {0.9, {1, 0}},
                         {1.0, {4, 0}}, {1.0, {4, 0}}, {2.0, {4, 4}}};
    CHECK(find_length_mm(uneven) == 8.0);
    const std::vector<point> at = divide(uneven, 4);
    CHECK(at == std::vector<point>{{0, 0}, {2, 0}, {4, 0}, {4, 2}, {4, 4}});
    CHECK(divide({{0.0, {3, 4}}}, 2) == std::vector<point>(3, {3, 4}));
}

TEST_CASE("figures of a path: moved, turned, bent and shortened lines")
{
    const drawing target = line({0, 0}, {60, 0}, 7);
    const path_errors same = compare_paths(line({0, 0}, {60, 0}, 333), target);
    CHECK(same.distance_mm == Approx(0.0));
    CHECK(same.frechet_mm == Approx(0.0));
    CHECK(same.length == Approx(1.0));
    CHECK(same.direction == Approx(0.0));
    CHECK(same.curvature == Approx(0.0));

    const path_errors moved = compare_paths(line({3, 4}, {63, 4}, 50), target);
    CHECK(moved.distance_mm == Approx(5.0));
    CHECK(moved.frechet_mm == Approx(5.0));
    CHECK(moved.direction == Approx(0.0));

    // From +x to +y, which is clockwise on a page.
    const double angle = std::numbers::pi / 6.0;
    const path_errors turned =
        compare_paths(line({0, 0}, {60 * std::cos(angle), 60 * std::sin(angle)}, 9), target);
    CHECK(turned.direction == Approx(30.0));
    CHECK(turned.distance_mm == Approx(60.0 * std::sin(angle / 2.0)));
    CHECK(turned.frechet_mm == Approx(120.0 * std::sin(angle / 2.0)));

    CHECK(std::abs(*compare_paths(line({60, 0}, {0, 0}, 9), target).direction) == Approx(180.0));
    const path_errors half = compare_paths(line({0, 0}, {30, 0}, 9), target);
    CHECK(half.length == Approx(0.5));
    CHECK(half.distance_mm == Approx(15.0));
    CHECK(half.frechet_mm == Approx(30.0));

    // A half circle with the same chord.
    const path_errors bent = compare_paths(arc(30, -std::numbers::pi, 0), line({-30, 0}, {30, 0}, 7));
    CHECK(bent.length == Approx(std::numbers::pi / 2.0).epsilon(1e-4));
    CHECK(bent.direction == Approx(0.0));
    CHECK(bent.curvature == Approx(1000.0 / 30.0).epsilon(1e-4));
    CHECK(compare_paths(line({-30, 0}, {30, 0}, 7), arc(30, -std::numbers::pi, 0)).curvature ==
          Approx(-1000.0 / 30.0).epsilon(1e-4));
}

TEST_CASE("what a path does not have is missing: a direction of a circle, a length of a point")
{
    const drawing circle = arc(20, 0, 2.0 * std::numbers::pi);
    CHECK(find_curvature(circle) == Approx(50.0).epsilon(1e-4));
    CHECK_FALSE(compare_paths(circle, circle).direction);
    CHECK(compare_paths(arc(20, 2.0 * std::numbers::pi, 0), circle).curvature ==
          Approx(-100.0).epsilon(1e-4));
    const path_errors dot = compare_paths({{0.0, {3, 4}}}, line({0, 0}, {6, 8}, 3));
    CHECK(dot.length == 0.0);
    CHECK(dot.frechet_mm == Approx(5.0));
    CHECK_FALSE(dot.direction);
    CHECK_FALSE(dot.curvature);
    CHECK_FALSE(compare_paths(circle, {{0.0, {0, 0}}}).length);
}

// A long way there and a short one back: pairs at equal parts are far apart, and the Frechet distance pairs
// better.
TEST_CASE("the Frechet distance is at most the largest distance at equal parts, and at least the distance of "
          "the ends")
{
    const drawing target = line({0, 0}, {40, 0}, 41);
    drawing loop = line({0, 0}, {20, 0}, 21);
    for (const auto& [time_s, at] : arc(3, -std::numbers::pi, std::numbers::pi))
        loop.push_back({2.0 + time_s, {at.x_mm + 23, at.y_mm}});
    for (const auto& [time_s, at] : line({20, 0}, {40, 0}, 21))
        loop.push_back({4.0 + time_s, at});
    const path_errors e = compare_paths(loop, target);
    CHECK(e.frechet_mm < 7.0);
    CHECK(e.frechet_mm > 3.0);
    CHECK(compare_paths(line({0, 9}, {40, 0}, 5), target).frechet_mm == Approx(9.0));
}

// Numbers of the standard library, not those of the simulated observer.
TEST_CASE(
    "intervals of constant errors hold the truth in 95 % of studies, and variable errors find the noise")
{
    const run_outline run{.name = "run",
                          .file_name = "run",
                          .task = &find_task("locate"),
                          .motions = {"a", "b"},
                          .methods = {"m"}};
    std::mt19937_64 bits(20261130);
    std::normal_distribution<double> normal;
    constexpr std::size_t people = 8;
    constexpr std::size_t trials = 20;
    constexpr int studies = 400;
    constexpr double across_mm = 2.0;
    constexpr double along_mm = -1.0;
    int hold_across = 0;
    int hold_along = 0;
    double variable = 0.0;
    for (int study = 0; study < studies; ++study) {
        std::vector<std::vector<trial>> answers(people, std::vector<trial>(trials));
        std::vector<person_trials> all;
        for (std::vector<trial>& own : answers) {
            const double own_mm = normal(bits);
            for (std::size_t i = 0; i < trials; ++i) {
                own[i].motion = i % 2;
                const point target{i % 2 == 0 ? 0.0 : 40.0, 10.0};
                own[i].target = {{0.0, target}};
                own[i].drawn = {{0.0,
                                 {target.x_mm + across_mm + own_mm + 4.0 * normal(bits),
                                  target.y_mm + along_mm + own_mm + 3.0 * normal(bits)}}};
            }
            all.push_back({std::to_string(all.size()), &own});
        }
        const std::vector<result> rows = find_run_task(run).analyse(run, {all}, sigmoid::normal);
        const std::vector<measured_figure>& figures = list_values<drawn_answers>(rows)[0]->figures;
        const auto holds = [&](std::size_t k, double truth) {
            const interval& ci = *figures[k].test.ci;
            return ci.first <= truth && truth <= ci.second ? 1 : 0;
        };
        REQUIRE(figures[2].name == "constant_across");
        hold_across += holds(2, across_mm);
        hold_along += holds(1, along_mm);
        variable += *figures[4].test.mean / studies;
    }
    CHECK(hold_across >= studies * 92 / 100);
    CHECK(hold_across <= studies * 98 / 100);
    CHECK(hold_along >= studies * 92 / 100);
    CHECK(hold_along <= studies * 98 / 100);
    // The mean of a standard deviation with 18 degrees of freedom is 0.986 sigma.
    CHECK(variable == Approx(4.0 * 0.986).epsilon(0.01));
}

TEST_CASE("places are counted at the nearest target, by method")
{
    run_outline run{.name = "run",
                    .file_name = "run",
                    .task = &find_task("locate"),
                    .motions = {"a", "b", "c"},
                    .methods = {"m", "n"}};
    std::vector<trial> own;
    const auto add = [&](std::size_t motion, std::size_t method, double x_mm) {
        trial t{.motion = motion, .method_1 = method};
        t.target = {{0.0, {10.0 * static_cast<double>(motion), 0.0}}};
        t.drawn = {{0.0, {x_mm, 3.0}}};
        own.push_back(t);
    };
    add(0, 0, 1.0);
    add(1, 0, 4.0);
    add(1, 0, 5.0); // as near to a: counts for the motion that was played
    add(2, 1, 90.0);
    const auto counts = count_nearest_targets(run, {{{"01", &own}}});
    REQUIRE(counts.size() == 2);
    using table = std::vector<std::vector<std::size_t>>;
    CHECK(counts[0].counts == table{{1, 0, 0}, {1, 1, 0}, {0, 0, 0}});
    CHECK(counts[1].counts == table{{0, 0, 0}, {0, 0, 0}, {0, 0, 1}});
}

} // namespace
} // namespace tactor::study::test_drawings
