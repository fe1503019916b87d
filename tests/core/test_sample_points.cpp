// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "caught.hpp"
#include "core/trajectory/sample_points.hpp"

namespace sample_points_test {

using namespace tactor;

namespace {

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
    CHECK(caught_message([&] { static_cast<void>(detail::sample_points(t)); }).find("timed points") !=
          std::string::npos);
}

} // namespace sample_points_test
