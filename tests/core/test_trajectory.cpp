// SPDX-License-Identifier: MIT
// Trajectories, and the points by which they are sampled.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/trajectory/spans.hpp"
#include "has.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

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
    return caught_message([&] { return trajectory::timed(points); });
}

std::size_t curves_at_hand(const path& p)
{
    std::size_t count = 0;
    for (const path::impl::measured_curve& c : detail::access::of(p).curves)
        count += c.places != nullptr ? 1 : 0;
    return count;
}

double farthest_mm(const path& a, const path& b)
{
    constexpr int places = 20'000;
    double most = 0.0;
    for (int i = 0; i <= places; ++i) {
        const double s_mm = a.length_mm() * i / places;
        most = std::max(most, distance_mm(a.at(s_mm), b.at(s_mm)));
    }
    return most;
}

// Returns the largest error over the duration, 0 or more, as `error_at` finds it at one time.
template <class F>
double find_largest(const trajectory& t, const std::vector<timed_point>& points, F error_at)
{
    constexpr int steps = 20'000;
    const trajectory sampled = trajectory::timed(points);
    double most = 0.0;
    for (int k = 0; k <= steps; ++k)
        most = std::max(most, error_at(t.duration_s() * k / steps, sampled));
    return most;
}

// Returns the largest distance of the target from where the points say that it is, mm. Times within `near_s`
// of each other are the same.
double largest_error_mm(const trajectory& t, const std::vector<timed_point>& points)
{
    return find_largest(t, points, [&t](double at, const trajectory& sampled) {
        return distance_mm(t.position(at), sampled.position(at));
    });
}

// Returns how far the intensity leaves what the target has within 0.1 ms: it may jump.
double largest_intensity_error(const trajectory& t, const std::vector<timed_point>& points)
{
    return find_largest(t, points, [&t](double at, const trajectory& sampled) {
        const double before = t.intensity(at - 1e-4);
        const double after = t.intensity(at + 1e-4);
        const double now = sampled.intensity(at);
        return std::max(std::min(before, after) - now, now - std::max(before, after));
    });
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
    const std::string refusal = "path: it has no length (add duration_s to make it a tap)";
    CHECK(caught_message([&] { return trajectory::along(place, 0.0); }) == refusal);
    for (const movement& m : {movement{}, movement{.duration_s = 1.0, .intensity = {{0.0, 0.5}}},
                              movement{.rests = {{0.5, 1.0}}}})
        CHECK(caught_message([&] { return trajectory::along(place, m); }) == refusal);
}

TEST_CASE("durations and intensities out of range are refused")
{
    for (const double d : {0.0, -1.0, nan_value, infinite, 86400.1}) {
        CAPTURE(d);
        CHECK(caught_message([&] { line_in(d); }).find("duration_s: ") == 0);
        CHECK(caught_message([&] { return line_in(1.0).with_duration(d); }).find("duration_s: ") == 0);
    }
    CHECK(line_in(86400.0).duration_s() == 86400.0);
    for (const double a : {-0.1, nan_value, infinite, 1001.0}) {
        CAPTURE(a);
        has(caught_message([&] { return trajectory::along(path::from_svg("M 0 0 H 1"), 1.0, a); }),
            "intensity");
    }
}

TEST_CASE("senseless timed points are refused by their number")
{
    CHECK(timed_refusal({}).find("a stroke needs at least 2, but this one has 0") != std::string::npos);
    CHECK(timed_refusal({{0.0, {}}}).find("a stroke needs at least 2, but this one has 1") !=
          std::string::npos);
    CHECK(timed_refusal({{0.5, {}}, {1.0, {}}}) == "point 1: the first time is 0.5 s (start at 0 s)");
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}}, {1.0, {}}}) ==
          "point 3: time 1 s is not after the previous one, 1 s (put times in ascending order)");
    CHECK(timed_refusal({{0.0, {}}, {-1.0, {}}}).find("point 2: ") == 0);
    CHECK(timed_refusal({{0.0, {}}, {nan_value, {}}}).find("point 2: time nan") == 0);
    CHECK(timed_refusal({{nan_value, {}}, {1.0, {}}}).find("point 1: time nan") == 0);
    CHECK(timed_refusal({{0.0, {}}, {90000.0, {}}}).find("point 2: time 90000") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {nan_value, 0.0}}}).find("point 2: coordinate nan") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {0.0, 1.1e6}}}).find("point 2: coordinate 1.1e+06") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}, -1.0}}).find("point 2: intensity -1") == 0);
    CHECK(timed_refusal({{0.0, {}}, {1.0, {}, infinite}}).find("point 2: intensity inf") == 0);
}

TEST_CASE("places at hand are within 1e-9 mm of those that are computed, at cusps and in narrow turns, too")
{
    std::vector<std::string> all(test::awkward_curves.begin(), test::awkward_curves.end());
    all.emplace_back("M 2 20 A 18 9 20 1 1 30 30");
    all.emplace_back("M 0 0 A 30 0.01 0 1 1 40 0");
    all.emplace_back("M 0 0 A 20 20 0 1 1 10 0");
    std::mt19937_64 random(43);
    for (int i = 0; i < test::rounds(16, 100); ++i)
        all.push_back(test::random_path(random, 5));
    std::size_t at_hand = 0;
    for (const std::string& data : all) {
        CAPTURE(data);
        const path p = path::from_svg(data);
        const path quick = detail::with_places(p, 1e-6);
        at_hand += curves_at_hand(quick);
        CHECK(quick.length_mm() == p.length_mm());
        CHECK(farthest_mm(p, quick) < (p.length_mm() > 1e3 ? 1e-7 : 1e-9));
        CHECK(curves_at_hand(p) == 0);
    }
    CHECK(at_hand > all.size());
}

TEST_CASE("curves that are passed in a moment are computed")
{
    const path curve = path::from_svg("M 0 10 C 20 -5 20 45 40 30");
    CHECK(curves_at_hand(detail::with_places(curve, curve.length_mm() / 300)) == 1);
    CHECK(curves_at_hand(detail::with_places(curve, curve.length_mm() / 200)) == 0);
}

TEST_CASE("a path of kilometres or of very many curves takes no more than some megabytes")
{
    const path huge =
        path::from_svg("M 0 0 C 900000 400000 -900000 500000 800000 1 A 300000 10 0 0 1 300000 1");
    CHECK(farthest_mm(huge, detail::with_places(huge, 1e-3)) < 1e-6);
    std::string many = "M 0 0";
    for (int i = 0; i < 4000; ++i)
        many += " q 10 30 20 0 q -10 -30 -20 0";
    const path p = path::from_svg(many);
    const std::size_t at_hand = curves_at_hand(detail::with_places(p, 1e-6));
    CHECK(at_hand > 500);
    CHECK(at_hand < 1000);
}

TEST_CASE("timed points are given back as they are, or stretched")
{
    const std::vector<timed_point> own{
        {0.0, {0.0, 0.0}, 1.0}, {0.1, {3.0, 4.0}, 0.5}, {0.4, {3.0, 4.0}, 0.0}};
    const auto same = detail::sample_points(trajectory::timed(own));
    REQUIRE(same.size() == 3);
    for (std::size_t i = 0; i < own.size(); ++i) {
        CHECK(same[i].t_s == own[i].t_s);
        CHECK(same[i].position == own[i].position);
        CHECK(same[i].intensity == own[i].intensity);
    }
    const auto longer = detail::sample_points(trajectory::timed(own).with_duration(0.8).with_intensity(0.5));
    CHECK(longer[1].t_s == doctest::Approx(0.2));
    CHECK(longer[2].t_s == 0.8);
    CHECK(longer[1].intensity == 0.25);
}

TEST_CASE("paths are sampled closely, and lines not at all")
{
    CHECK(detail::sample_points(trajectory::along(path::from_svg("M 0 0 L 40 0 L 40 40"), 2.0)).size() == 3);
    CHECK(detail::sample_points(trajectory::along(path::from_svg("M 5 5"), 0.3)).size() == 2);
    for (const char* data :
         {"M 0 10 C 20 -5 20 45 40 30 L 60 30 A 15 10 0 0 1 60 50", "M 0 0 C 40 0 0 40 40 40",
          "M 20 5 A 15 15 0 0 1 20 35 A 15 15 0 0 1 20 5 Z", "M 0 0 A 3000 3000 0 0 1 6000 0"})
        for (const easing_kind easing : all_values<easing_kind>()) {
            CAPTURE(data);
            movement m{.duration_s = 2.0, .easing = easing};
            m.speed_mm_s = {{0.0, 1.0}, {0.3, 4.0}};
            m.intensity = {{0.2, 0.1}, {0.6, 1.0}};
            m.rests = {{0.25, 0.3, 0.0}, {1.0, 0.1, 0.5}};
            const trajectory t = trajectory::along(path::from_svg(data), m);
            const auto points = detail::sample_points(t);
            CHECK(points.front().t_s == 0.0);
            CHECK(points.back().t_s == t.duration_s());
            CHECK(largest_error_mm(t, points) < 0.01);
            CHECK(largest_intensity_error(t, points) < 0.01);
            CHECK(points.size() < 10'000);
        }
}

TEST_CASE("what takes too many points is refused")
{
    std::string data = "M 0 0";
    for (int i = 0; i < 2000; ++i)
        data += " A 90000 90000 0 0 1 0 90000 A 90000 90000 0 0 1 0 0";
    const trajectory t = trajectory::along(path::from_svg(data), 86400.0);
    has(caught_message([&] { return detail::sample_points(t); }), "timed points");
}

} // namespace trajectory_test
