// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/percept.hpp>

#include "../plan/arrays.hpp"
#include "../plan/strokes.hpp"

namespace path_errors_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr double pi = std::numbers::pi;

/// Makes samples of a target and of what is felt of it, both functions of the time in ms.
template <class Target, class Felt>
std::vector<percept_sample> make_samples(int count, Target target, Felt felt)
{
    std::vector<percept_sample> samples;
    for (int i = 0; i < count; ++i)
        samples.push_back({.t_s = 0.001 * i, .target = target(i), .felt = felt(i), .intensity = 1.0});
    return samples;
}

point on_circle(double radius_mm, double angle)
{
    return {radius_mm * std::cos(angle), radius_mm * std::sin(angle)};
}

/// Returns the distance from a piece of a line by its foot, or by its ends where the foot is not on it.
double off_piece(point p, point a, point b)
{
    const double length = distance_mm(a, b);
    const double to_end = std::min(distance_mm(p, a), distance_mm(p, b));
    if (length == 0.0)
        return to_end;
    const double x = (b.x_mm - a.x_mm) / length;
    const double y = (b.y_mm - a.y_mm) / length;
    const double at = (p.x_mm - a.x_mm) * x + (p.y_mm - a.y_mm) * y;
    return at > 0.0 && at < length ? std::abs((p.x_mm - a.x_mm) * y - (p.y_mm - a.y_mm) * x) : to_end;
}

doctest::Approx near(double v, double within = 1e-9)
{
    return doctest::Approx(v).epsilon(within);
}

} // namespace

TEST_CASE("a line that is felt 35 ms late: lag, and error along it")
{
    // 0.05 mm each ms. At t the felt place is that of t - 35 ms, and before that the start.
    const auto target = [](int i) { return point{0.05 * i, 3.0}; };
    const percept_summary r =
        summarise(make_samples(1001, target, [&](int i) { return target(std::max(0, i - 35)); }));
    double squares = 966.0 * 35.0 * 35.0;
    for (int i = 0; i < 35; ++i)
        squares += i * i;
    const double rms_mm = 0.05 * std::sqrt(squares / 1001.0);
    CHECK(*r.lag_s == near(0.035));
    CHECK(*r.rms_at_lag_mm < 1e-12);
    CHECK(*r.rms_error_mm == near(rms_mm));
    CHECK(*r.largest_error_mm == near(1.75));
    CHECK(*r.along_rms_mm == near(rms_mm));
    CHECK(*r.along_max_mm == near(1.75));
    CHECK(*r.across_rms_mm < 1e-12);
    CHECK(*r.across_max_mm < 1e-12);
    CHECK(*r.rms_to_path_mm < 1e-12);
}

TEST_CASE("a circle that is felt late, and one that is felt 2 mm outside")
{
    const auto angle = [](int i) { return 2.0 * pi * i / 1000.0; };
    const auto target = [&](int i) { return on_circle(16.0, angle(i)); };
    // From 90 ms on, so that the circle before the start is not needed.
    const percept_summary late = summarise(make_samples(1001, target, [&](int i) -> std::optional<point> {
        return i < 90 ? std::nullopt : std::optional(target(i - 90));
    }));
    CHECK(*late.lag_s == near(0.09));
    CHECK(*late.rms_at_lag_mm < 1e-12);
    CHECK(*late.rms_error_mm == near(32.0 * std::sin(angle(90) / 2.0)));
    CHECK(*late.along_max_mm == near(16.0 * std::sin(angle(90)), 1e-3)); // at the end from one side only
    CHECK(*late.along_rms_mm == near(16.0 * std::sin(angle(90)), 1e-5));
    CHECK(*late.across_rms_mm == near(16.0 * (1.0 - std::cos(angle(90))), 1e-4));
    CHECK(*late.rms_to_path_mm < 1e-12);

    const percept_summary wide =
        summarise(make_samples(1001, target, [&](int i) { return on_circle(18.0, angle(i)); }));
    CHECK(*wide.lag_s == 0.0);
    CHECK(*wide.rms_at_lag_mm == near(2.0));
    CHECK(*wide.across_rms_mm == near(2.0, 1e-5));
    CHECK(*wide.across_max_mm == near(2.0, 1e-5));
    CHECK(*wide.along_rms_mm < 1e-3);
    CHECK(*wide.rms_to_path_mm == near(2.0));
}

TEST_CASE("lags end at 0.2 s, and none is below 0")
{
    const auto target = [](int i) { return point{0.05 * i, 0.0}; };
    const auto shifted = [&](int by_ms) {
        return summarise(make_samples(1001, target, [&](int i) { return target(i - by_ms); }));
    };
    CHECK(*shifted(300).lag_s == longest_lag_s);
    CHECK(*shifted(300).rms_at_lag_mm < *shifted(300).rms_error_mm);
    CHECK(*shifted(200).lag_s == near(0.2));
    CHECK(*shifted(-20).lag_s == 0.0);
    CHECK(*shifted(-20).rms_at_lag_mm == *shifted(-20).rms_error_mm);
}

TEST_CASE("lag and distance from the path by brute force")
{
    std::mt19937 random(7);
    const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
    // A walk that crosses itself, rests and jumps, with lengths about the width of the boxes of the search.
    for (const int count : {1, 2, 15, 16, 17, 18, 255, 257, 258, 700}) {
        CAPTURE(count);
        std::vector<point> targets{{20.0 * unit(), 20.0 * unit()}};
        std::vector<std::optional<point>> felt;
        for (int i = 0; i < count; ++i) {
            const point last = targets.back();
            const double step = i % 7 == 0 ? 0.0 : 0.6;
            targets.push_back({last.x_mm + step * (unit() - 0.5), last.y_mm + step * (unit() - 0.4)});
            if (i % 5 == 3)
                felt.push_back(std::nullopt);
            else if (i % 5 == 2 && felt.back())
                felt.push_back(felt.back());
            else
                felt.push_back(point{40.0 * unit() - 10.0, 60.0 * unit() - 10.0});
        }
        targets.pop_back();
        const auto at = [&](int i) { return targets[static_cast<std::size_t>(std::max(0, i))]; };
        const percept_summary r =
            summarise(make_samples(count, at, [&](int i) { return felt[static_cast<std::size_t>(i)]; }));
        double best = 1e300;
        int lag = 0;
        double off_path = 0.0;
        double n = 0.0;
        for (int by = 0; by <= 200; ++by) {
            double squares = 0.0;
            for (int i = 0; i < count; ++i)
                if (const auto& f = felt[static_cast<std::size_t>(i)])
                    squares += std::pow(distance_mm(*f, at(i - by)), 2);
            if (squares < best * (1.0 - 1e-12)) {
                best = squares;
                lag = by;
            }
        }
        for (const auto& f : felt) {
            if (!f)
                continue;
            double off = distance_mm(*f, targets[0]);
            for (std::size_t k = 1; k < targets.size(); ++k)
                off = std::min(off, off_piece(*f, targets[k - 1], targets[k]));
            off_path += off * off;
            ++n;
        }
        CHECK(*r.lag_s == near(0.001 * lag));
        CHECK(*r.rms_at_lag_mm == near(std::sqrt(best / n)));
        CHECK(*r.rms_to_path_mm == near(std::sqrt(off_path / n)));
    }
}

TEST_CASE("a path that goes round a hundred times is one circle")
{
    // 140.3 ms for each turn: no two turns have the same places.
    const auto target = [](int i) { return on_circle(16.0, 2.0 * pi * i / 140.3); };
    const percept_summary r = summarise(
        make_samples(14000, target, [](int i) { return on_circle(16.0 + 0.3 * (i % 3 - 1), 0.7 * i); }));
    // 0.3 mm inside, on it, 0.3 mm outside. Straight pieces are up to 0.004 mm inside of the circle.
    CHECK(*r.rms_to_path_mm == doctest::Approx(0.3 * std::sqrt(2.0 / 3.0)).epsilon(0.02));
}

TEST_CASE("while the target rests, its last movement is the direction, and before it moves its first")
{
    // Rests at (0, 0), goes right by 10 mm, rests, goes down by 10 mm, rests. All felt 1 mm right and 2 mm
    // below.
    const auto target = [](int i) {
        return point{0.1 * std::clamp(i - 100, 0, 100), 0.1 * std::clamp(i - 300, 0, 100)};
    };
    const auto samples = make_samples(501, target, [&](int i) {
        return point{target(i).x_mm + 1.0, target(i).y_mm + 2.0};
    });
    const auto first = [&samples](int n) {
        return std::vector<percept_sample>(samples.begin(), samples.begin() + n);
    };
    const percept_summary right = summarise(first(300));
    CHECK(*right.along_rms_mm == near(1.0));
    CHECK(*right.across_rms_mm == near(2.0));
    const percept_summary both = summarise(samples); // it turns at 300 ms
    CHECK(*both.along_rms_mm == near(std::sqrt((300.0 * 1.0 + 201.0 * 4.0) / 501.0)));
    CHECK(*both.across_rms_mm == near(std::sqrt((300.0 * 4.0 + 201.0 * 1.0) / 501.0)));
    CHECK(*both.across_max_mm == near(2.0));

    const percept_summary still = summarise(first(100));
    CHECK_FALSE(still.along_rms_mm);
    CHECK_FALSE(still.across_max_mm);
    CHECK(*still.lag_s == 0.0);
    CHECK(*still.rms_to_path_mm == near(std::sqrt(5.0)));
}

TEST_CASE("what is not felt has no errors")
{
    const percept_summary r = summarise(make_samples(
        10,
        [](int i) {
            return point{0.1 * i, 0.0};
        },
        [](int) { return std::optional<point>(); }));
    for (const auto& v : {r.lag_s, r.rms_at_lag_mm, r.along_rms_mm, r.along_max_mm, r.across_rms_mm,
                          r.across_max_mm, r.rms_to_path_mm})
        CHECK_FALSE(v);
}

TEST_CASE("the presets' half circle has the errors that a program with its equations gives")
{
    struct expected {
        plan_options how;
        double rms, lag_s, at_lag, along, along_max, across, across_max, to_path;
    };
    using enum algorithm_kind;
    for (const expected& e :
         {expected{{.phantom = phantom_kind::barycentric},
                   1.434099,
                   0.035,
                   0.716566,
                   1.431485,
                   2.467483,
                   0.086545,
                   0.191410,
                   0.0},
          expected{{}, 2.094158, 0.035, 1.684544, 2.076332, 5.285772, 0.272661, 0.841733, 0.223959},
          expected{{.algorithm = tactile_brush},
                   6.719758,
                   0.0,
                   6.719758,
                   4.486048,
                   8.829562,
                   5.003052,
                   8.926187,
                   4.035692}}) {
        const stroke s = preset_stroke("park2016-1");
        const percept_summary r = summarise(palm, s, make_plan(palm, s, e.how));
        const auto close = [](double a, double b) { CHECK(std::abs(a - b) < 2e-4); };
        close(*r.rms_error_mm, e.rms);
        close(*r.lag_s, e.lag_s);
        close(*r.rms_at_lag_mm, e.at_lag);
        close(*r.along_rms_mm, e.along);
        close(*r.along_max_mm, e.along_max);
        close(*r.across_rms_mm, e.across);
        close(*r.across_max_mm, e.across_max);
        close(*r.rms_to_path_mm, e.to_path);
    }
}

} // namespace path_errors_test
