// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"

namespace trajectory_test {

using namespace tactor;

namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();
const double infinite = std::numeric_limits<double>::infinity();

trajectory line_in(double duration_s)
{
    return trajectory::along(path::from_svg("M 0 10 L 40 30"), duration_s);
}

std::string timed_refusal(std::vector<timed_point> points)
{
    return caught_message([&] { static_cast<void>(trajectory::timed(points)); });
}

} // namespace

TEST_CASE("a default stroke rests at the origin")
{
    const tactor::stroke s;
    CHECK(s.motion.duration_s() == 1.0);
    CHECK(s.motion.length_mm() == 0.0);
    CHECK(s.motion.position(0.5) == point{});
    CHECK(s.motion.intensity(0.5) == 1.0);
}

TEST_CASE("along a path, the distance is in proportion to time")
{
    const trajectory t = line_in(2.0);
    CHECK(t.duration_s() == 2.0);
    CHECK(t.length_mm() == doctest::Approx(std::sqrt(2000.0)));
    CHECK(t.position(1.0).x_mm == doctest::Approx(20.0).epsilon(1e-14));
    CHECK(t.position(1.0).y_mm == doctest::Approx(20.0).epsilon(1e-14));
    CHECK(t.position(-1.0) == point{0.0, 10.0});
    CHECK(t.position(3.0) == point{40.0, 30.0});
    CHECK(t.position(2.0) == point{40.0, 30.0});
    CHECK(t.position(nan_value) == point{0.0, 10.0});
    CHECK(t.intensity(1.0) == 1.0);
    CHECK(trajectory::along(path::from_svg("M 0 0 H 1"), 1.0, 0.25).intensity(9.0) == 0.25);
}

TEST_CASE("between timed points, place and intensity are linear")
{
    const trajectory t =
        trajectory::timed({{0.0, {0.0, 0.0}, 1.0}, {1.0, {3.0, 4.0}, 0.5}, {3.0, {3.0, 10.0}, 0.0}});
    CHECK(t.duration_s() == 3.0);
    CHECK(t.length_mm() == 11.0);
    CHECK(t.position(0.5) == point{1.5, 2.0});
    CHECK(t.position(2.0) == point{3.0, 7.0});
    CHECK(t.intensity(0.5) == 0.75);
    CHECK(t.intensity(2.0) == 0.25);
    CHECK(t.position(-1.0) == point{0.0, 0.0});
    CHECK(t.position(99.0) == point{3.0, 10.0});
    CHECK(t.intensity(-1.0) == 1.0);
    CHECK(t.intensity(99.0) == 0.0);
    CHECK(t.position(nan_value) == point{0.0, 0.0});
    CHECK(t.position(1.0) == point{3.0, 4.0});
}

TEST_CASE("another duration is the same movement at another pace")
{
    const trajectory t =
        trajectory::timed({{0.0, {0.0, 0.0}, 1.0}, {1.0, {3.0, 4.0}, 0.5}, {3.0, {3.0, 10.0}, 0.0}})
            .with_duration(6.0);
    CHECK(t.duration_s() == 6.0);
    CHECK(t.position(1.0) == point{1.5, 2.0});
    CHECK(t.intensity(4.0) == 0.25);
    CHECK(t.position(6.0) == point{3.0, 10.0});
    REQUIRE(t.meets_y(7.0).size() == 1);
    CHECK(t.meets_y(7.0)[0] == doctest::Approx(4.0));
    CHECK(line_in(2.0).with_duration(4.0).position(2.0).x_mm == doctest::Approx(20.0));
    // The shortest that a double can express.
    const trajectory blink = t.with_duration(5e-324);
    CHECK(blink.position(0.0) == point{0.0, 0.0});
    CHECK(blink.position(1.0) == point{3.0, 10.0});
    CHECK(std::isfinite(blink.intensity(5e-324)));
}

TEST_CASE("intensity is scaled with the movement as it was")
{
    const trajectory t = trajectory::timed({{0.0, {0.0, 0.0}, 1.0}, {1.0, {3.0, 4.0}, 0.5}});
    const trajectory half = t.with_intensity(0.5).with_duration(2.0);
    CHECK(half.intensity(0.0) == 0.5);
    CHECK(half.intensity(1.0) == 0.375);
    CHECK(half.position(1.0) == point{1.5, 2.0});
    CHECK(line_in(1.0).with_intensity(0.5).with_intensity(0.5).intensity(0.0) == 0.25);
    CHECK_THROWS_AS(t.with_intensity(-1.0), tactor::error);
    CHECK_THROWS_AS(t.with_intensity(nan_value), tactor::error);
    CHECK_THROWS_AS(t.with_intensity(infinite), tactor::error);
    CHECK_THROWS_AS(t.with_intensity(1.01), tactor::error);
    CHECK(t.with_intensity(0.5).with_intensity(2.0).intensity(0.0) == 1.0);
    CHECK_THROWS_AS(trajectory::timed({{0.0, {}, 1.0}, {1.0, {}, 1.01}}), tactor::error);
}

TEST_CASE("trajectories give the times at which the target meets a line of the grid")
{
    const trajectory t = line_in(2.0);
    REQUIRE(t.meets_x(20.0).size() == 1);
    CHECK(t.meets_x(20.0)[0] == doctest::Approx(1.0).epsilon(1e-14));
    CHECK(t.meets_y(40.0).empty());
    const trajectory timed = trajectory::timed({{0.0, {0.0, 0.0}}, {1.0, {10.0, 0.0}}, {3.0, {0.0, 5.0}}});
    CHECK(timed.meets_x(5.0) == std::vector<double>{0.5, 2.0});
    CHECK(timed.meets_x(10.0) == std::vector<double>{1.0});
    CHECK(timed.meets_y(0.0).empty());
    CHECK(timed.meets_y(nan_value).empty());
}

TEST_CASE("a target that rests on a line meets it when it arrives")
{
    const trajectory t = trajectory::timed(
        {{0.0, {0.0, 0.0}}, {1.0, {10.0, 0.0}}, {5.0, {10.0, 0.0}}, {6.0, {20.0, 0.0}}, {7.0, {20.0, 0.0}}});
    CHECK(t.meets_x(10.0) == std::vector<double>{1.0});
    CHECK(t.meets_x(20.0) == std::vector<double>{6.0});
    CHECK(t.meets_x(0.0) == std::vector<double>{0.0});
    // It trembles by less than a nanometre.
    const trajectory u = trajectory::timed(
        {{0.0, {0.0, 0.0}}, {1.0, {10.0 + 4e-7, 0.0}}, {2.0, {10.0 - 4e-7, 0.0}}, {6.0, {20.0, 0.0}}});
    REQUIRE(u.meets_x(10.0).size() == 1);
    CHECK(u.meets_x(10.0)[0] == doctest::Approx(1.0).epsilon(1e-6));
    // It stays on one place all the time.
    const trajectory still = trajectory::timed({{0.0, {5.0, 5.0}}, {1.0, {5.0, 5.0}}});
    CHECK(still.length_mm() == 0.0);
    CHECK(still.meets_x(5.0) == std::vector<double>{0.0});
    CHECK(still.position(0.5) == point{5.0, 5.0});
}

TEST_CASE("a path of one place is a tap of the given duration")
{
    const path place = path::from_svg("M 5 7");
    const trajectory tap = trajectory::along(place, 0.4, 0.5);
    CHECK(tap.duration_s() == 0.4);
    CHECK(tap.length_mm() == 0.0);
    CHECK(tap.position(0.3) == point{5.0, 7.0});
    CHECK(tap.intensity(0.3) == 0.5);
    CHECK(tap.reversed().position(0.0) == point{5.0, 7.0});
    CHECK(tap.with_speed(60.0).duration_s() == 0.4);
    const movement reach{.duration_s = 2.0, .easing = easing_kind::minimum_jerk};
    CHECK(trajectory::along(place, reach).duration_s() == 2.0);
    const std::string refusal = "path: has no length (duration_s makes it a tap)";
    CHECK(caught_message([&] { static_cast<void>(trajectory::along(place, 0.0)); }) == refusal);
    for (const movement& m : {movement{}, movement{.duration_s = 1.0, .intensity = {{0.0, 0.5}}},
                              movement{.rests = {{0.5, 1.0}}}})
        CHECK(caught_message([&] { static_cast<void>(trajectory::along(place, m)); }) == refusal);
}

TEST_CASE("durations and intensities out of range are refused")
{
    for (const double d : {0.0, -1.0, nan_value, infinite, 86400.1}) {
        CAPTURE(d);
        CHECK(caught_message([&] { line_in(d); }).find("duration: ") == 0);
        CHECK(caught_message([&] { static_cast<void>(line_in(1.0).with_duration(d)); }).find("duration: ") ==
              0);
    }
    CHECK(line_in(86400.0).duration_s() == 86400.0);
    for (const double a : {-0.1, nan_value, infinite, 1001.0}) {
        CAPTURE(a);
        CHECK(caught_message([&] {
                  static_cast<void>(trajectory::along(path::from_svg("M 0 0 H 1"), 1.0, a));
              }).find("intensity") != std::string::npos);
    }
}

TEST_CASE("senseless timed points are refused by their number")
{
    CHECK(timed_refusal({}).find("0 of at least 2") != std::string::npos);
    CHECK(timed_refusal({{0.0, {}}}).find("1 of at least 2") != std::string::npos);
    CHECK(timed_refusal({{0.5, {}}, {1.0, {}}}) == "point 1: time 0.5 s (the first time is 0)");
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}}, {1.0, {}}}) ==
          "point 3: time 1 s is not after 1 s (times ascend)");
    CHECK(timed_refusal({{0.0, {}}, {-1.0, {}}}).find("point 2: ") == 0);
    CHECK(timed_refusal({{0.0, {}}, {nan_value, {}}}).find("point 2: time nan") == 0);
    CHECK(timed_refusal({{nan_value, {}}, {1.0, {}}}).find("point 1: time nan") == 0);
    CHECK(timed_refusal({{0.0, {}}, {90000.0, {}}}).find("point 2: time 90000") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {nan_value, 0.0}}}).find("point 2: coordinate nan") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {0.0, 1.1e6}}}).find("point 2: coordinate 1.1e+06") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}, -1.0}}).find("point 2: intensity -1") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}, infinite}}).find("point 2: intensity inf") == 0);
}

TEST_CASE("a timed walk meets each line where the walk is on it")
{
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> n(-30.0, 30.0);
    for (int k = 0; k < 2000; ++k) {
        std::vector<timed_point> points;
        for (int i = 0; i < 20; ++i)
            points.push_back({0.1 * i, {std::round(n(random)), std::round(n(random))}, 1.0});
        const trajectory t = trajectory::timed(points).with_duration(3.0);
        double last = -1.0;
        bool good = true;
        for (const double time : t.meets_x(5.0)) {
            good = good && time > last && std::abs(t.position(time).x_mm - 5.0) < 1e-9;
            last = time;
        }
        CHECK(good);
    }
}

} // namespace trajectory_test
