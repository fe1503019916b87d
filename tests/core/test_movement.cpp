// SPDX-License-Identifier: MIT
// Movements along a path, and portable distances.
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "core/path/shape.hpp"
#include "core/trajectory/spans.hpp"

namespace movement_test {

using namespace tactor;

namespace {

const path line = path::from_svg("M 0 10 H 40");
const path bend = path::from_svg("M 0 10 C 20 -5 20 45 40 30 L 60 30 A 15 10 0 0 1 60 50");

double minimum_jerk(double u)
{
    return 10.0 * std::pow(u, 3) - 15.0 * std::pow(u, 4) + 6.0 * std::pow(u, 5);
}

double smooth(double u)
{
    return 3.0 * u * u - 2.0 * u * u * u;
}

std::string refusal(const movement& m)
{
    return caught_message([&] { return trajectory::along(line, m); });
}

/// Draws rests, speeds and intensities at random places.
movement random_movement(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> any(0.0, 1.0);
    movement m;
    m.easing = all_values<easing_kind>()[random() % 3];
    const auto parts = [&] {
        std::vector<double> all;
        for (double p = 0.3 * any(random); p <= 1.0; p += 0.05 + 0.4 * any(random))
            all.push_back(p);
        return all;
    };
    for (const double p : parts())
        m.speed_mm_s.push_back({p, 5.0 + 200.0 * any(random)});
    for (const double p : parts())
        m.intensity.push_back({p, any(random)});
    for (const double p : parts())
        m.rests.push_back({p, 0.01 + any(random), any(random)});
    return m;
}

} // namespace

TEST_CASE("minimum jerk is its polynomial, and in-out its parabola's integral")
{
    for (const double duration_s : {0.37, 1.0, 1.4, 3600.0}) {
        const trajectory jerk =
            trajectory::along(line, {.duration_s = duration_s, .easing = easing_kind::minimum_jerk});
        const trajectory in_out =
            trajectory::along(line, {.duration_s = duration_s, .easing = easing_kind::in_out});
        REQUIRE(jerk.duration_s() == duration_s);
        for (int i = 0; i <= 1000; ++i) {
            const double t = duration_s * i / 1000.0;
            CHECK(std::abs(jerk.position(t).x_mm / 40.0 - minimum_jerk(t / duration_s)) < 1e-12);
            CHECK(std::abs(in_out.position(t).x_mm / 40.0 - smooth(t / duration_s)) < 1e-12);
        }
        CHECK(jerk.position(duration_s) == point{40.0, 10.0});
        CHECK(jerk.position(-1.0) == point{0.0, 10.0});
    }
    // Along a curve the arc length is eased.
    const trajectory t = trajectory::along(bend, {.duration_s = 2.0, .easing = easing_kind::minimum_jerk});
    for (int i = 0; i <= 100; ++i) {
        const point p = bend.at(bend.length_mm() * minimum_jerk(i / 100.0));
        CHECK(distance_mm(t.position(2.0 * i / 100.0), p) < 1e-9);
    }
}

TEST_CASE("an easing and its inverse are exact at both ends and symmetric")
{
    for (const easing_kind k : all_values<easing_kind>()) {
        const trajectory t = trajectory::along(line, {.duration_s = 1.0, .easing = k});
        CHECK(t.position(0.5).x_mm == doctest::Approx(20.0).epsilon(1e-15));
        for (const double x : {1e-9, 1e-3, 7.0, 19.999, 20.0, 33.0, 40.0 - 1e-9}) {
            const std::vector<double> when = t.meets_x(x);
            REQUIRE(when.size() == 1);
            CHECK(std::abs(t.position(when[0]).x_mm - x) < 1e-13 * 40.0);
        }
        CHECK(t.meets_x(0.0) == std::vector<double>{0.0});
        CHECK(t.meets_x(40.0) == std::vector<double>{1.0});
    }
    CHECK(from_string<easing_kind>("minimum-jerk") == easing_kind::minimum_jerk);
}

TEST_CASE("speeds follow the profile at the target's place, and times follow them")
{
    const std::vector<profile_point> speeds{{0.0, 20.0}, {0.25, 80.0}, {0.5, 80.0}, {1.0, 10.0}};
    const trajectory t = trajectory::along(line, {.speed_mm_s = speeds});
    const double by_hand =
        10.0 * std::log(4.0) / 60.0 + 10.0 / 80.0 + 20.0 * std::log(8.0) / 70.0; // of dx / v, v linear in x
    CHECK(t.duration_s() == doctest::Approx(by_hand).epsilon(1e-14));
    for (int i = 1; i < 200; ++i) {
        const double when = t.duration_s() * i / 200.0;
        constexpr double h = 1e-5;
        const double x = t.position(when).x_mm / 40.0;
        const double v = (t.position(when + h).x_mm - t.position(when - h).x_mm) / (2.0 * h);
        const double said = x < 0.25 ? 20.0 + 240.0 * x : x < 0.5 ? 80.0 : 80.0 - 140.0 * (x - 0.5);
        CHECK(v == doctest::Approx(said).epsilon(2e-4));
    }
    // A single speed is that speed; with a duration only ratios count; without either it is the usual one.
    CHECK(trajectory::along(line, {.speed_mm_s = {{0.5, 20.0}}}).duration_s() == 2.0);
    CHECK(trajectory::along(line, movement{}).duration_s() == doctest::Approx(40.0 / 60.0));
    const trajectory slow = trajectory::along(line, {.duration_s = 3.0, .speed_mm_s = speeds});
    CHECK(slow.position(1.0).x_mm == doctest::Approx(t.position(t.duration_s() / 3.0).x_mm).epsilon(1e-13));
}

TEST_CASE("a rest takes its time, and each stretch between rests goes from rest to rest")
{
    const movement m{.duration_s = 3.0,
                     .easing = easing_kind::minimum_jerk,
                     .rests = {{0.0, 0.25}, {0.25, 0.5, 0.0}, {1.0, 0.25}}};
    const trajectory t = trajectory::along(line, m);
    REQUIRE(t.duration_s() == 3.0); // 2 s of movement: half a second, and one and a half
    CHECK(t.position(0.25) == point{0.0, 10.0});
    CHECK(t.position(0.5).x_mm == doctest::Approx(10.0 * minimum_jerk(0.5)));
    CHECK(t.position(0.75) == point{10.0, 10.0});
    CHECK(t.position(1.1) == point{10.0, 10.0});
    CHECK(t.position(1.25) == point{10.0, 10.0});
    CHECK(t.position(2.0).x_mm == doctest::Approx(10.0 + 30.0 * minimum_jerk(0.5)));
    CHECK(t.position(2.75) == point{40.0, 10.0});
    CHECK(t.intensity(0.7) == 1.0);
    CHECK(t.intensity(1.0) == 0.0); // it rests in silence
    CHECK(t.intensity(1.3) == 1.0);
    CHECK(t.meets_x(10.0) == std::vector<double>{0.75}); // on arrival
    CHECK(t.meets_x(40.0) == std::vector<double>{2.75});
    CHECK(t.meets_x(0.0) == std::vector<double>{0.0});
}

TEST_CASE("intensity follows the part of the path, for any movement")
{
    const std::vector<profile_point> ramp{{0.25, 0.2}, {0.75, 1.0}};
    for (const easing_kind k : all_values<easing_kind>()) {
        const trajectory t = trajectory::along(line, {.duration_s = 1.0, .easing = k, .intensity = ramp}, 0.5)
                                 .with_intensity(0.5);
        for (int i = 0; i <= 50; ++i) {
            const double part = t.position(i / 50.0).x_mm / 40.0;
            const double factor = part < 0.25 ? 0.2 : part > 0.75 ? 1.0 : 0.2 + 1.6 * (part - 0.25);
            CHECK(t.intensity(i / 50.0) == doctest::Approx(0.25 * factor).epsilon(1e-12));
        }
    }
}

TEST_CASE("movements take another time, another speed, and reverse")
{
    const movement m{.duration_s = 2.0,
                     .easing = easing_kind::in_out,
                     .speed_mm_s = {{0.0, 1.0}, {1.0, 3.0}},
                     .intensity = {{0.0, 0.1}, {1.0, 0.9}},
                     .rests = {{0.3, 0.4, 0.5}}};
    const trajectory t = trajectory::along(bend, m);
    const trajectory slow = t.with_duration(5.0);
    const trajectory back = slow.reversed();
    CHECK(back.length_mm() == doctest::Approx(t.length_mm()).epsilon(1e-12));
    for (int i = 0; i <= 100; ++i) {
        const double when = 5.0 * i / 100.0;
        CHECK(distance_mm(slow.position(when), t.position(when / 2.5)) < 1e-9);
        CHECK(slow.intensity(when) == doctest::Approx(t.intensity(when / 2.5)));
        CHECK(distance_mm(back.position(5.0 - when), slow.position(when)) < 1e-9);
    }
    CHECK(back.intensity(5.0 - 1.0) == doctest::Approx(slow.intensity(1.0)));
    // The rest keeps its length.
    CHECK(t.with_speed(100.0).duration_s() == doctest::Approx(t.length_mm() / 100.0 + 0.4));
    CHECK(slow.with_speed(100.0).duration_s() == doctest::Approx(t.length_mm() / 100.0 + 1.0));
    const trajectory dots = trajectory::timed({{0.0, {0.0, 0.0}, 0.5}, {1.0, {3.0, 4.0}}, {4.0, {3.0, 9.0}}});
    const trajectory dots_back = dots.with_duration(8.0).reversed();
    CHECK(dots_back.position(0.0) == point{3.0, 9.0});
    CHECK(dots_back.position(7.0) == point{1.5, 2.0});
    CHECK(dots_back.intensity(8.0) == 0.5);
    CHECK(dots.with_speed(5.0).duration_s() == doctest::Approx(2.0));
    CHECK(trajectory::timed({{0.0, {1.0, 1.0}}, {1.0, {1.0, 1.0}}}).with_speed(5.0).duration_s() == 1.0);
}

TEST_CASE("for any movement, lines are met when the target is on them, in order")
{
    std::mt19937_64 random(15);
    for (int k = 0; k < 300; ++k) {
        const trajectory t = trajectory::along(bend, random_movement(random)).with_duration(4.0);
        for (const double x : {5.0, 20.0, 40.0, 59.0, 66.0}) {
            const std::vector<double> when = t.meets_x(x);
            CHECK(when.size() == bend.meets_x(x).size());
            double last = -1.0;
            bool good = true;
            for (const double w : when) {
                good = good && w > last && w <= 4.0 && std::abs(t.position(w).x_mm - x) < 1e-8;
                last = w;
            }
            CHECK(good);
        }
    }
}

TEST_CASE("spans hold the target's intensity and follow its time")
{
    std::mt19937_64 random(16);
    for (int k = 0; k < 100; ++k) {
        const trajectory t = trajectory::along(bend, random_movement(random)).with_intensity(0.7);
        double until = 0.0;
        detail::for_each_span(t, [&](const detail::trajectory_span& s) {
            CHECK(s.from_s == until);
            CHECK(s.to_s >= s.from_s);
            for (int i = 0; i <= 40; ++i)
                CHECK(t.intensity(s.from_s + (s.to_s - s.from_s) * i / 40.0) <= s.intensity * (1.0 + 1e-12));
            if (s.curve != nullptr) {
                const double when = s.time_at(0.4);
                CHECK(distance_mm(t.position(when), detail::position(*s.curve, 0.4)) < 1e-6);
            }
            until = s.to_s;
            return true;
        });
        CHECK(until == t.duration_s());
    }
}

TEST_CASE("extremes stay finite and in order")
{
    const movement steep{.duration_s = 86400.0,
                         .easing = easing_kind::minimum_jerk,
                         .speed_mm_s = {{0.0, 1e6}, {5e-324, 1e-6}, {0.5, 1e6}, {1.0, 1e-6}},
                         .rests = {{5e-324, 1e-300}, {0.5, 1.0}}};
    const trajectory t = trajectory::along(line, steep);
    double before = 0.0;
    for (int i = 0; i <= 1000; ++i) {
        const double x = t.position(86.4 * i).x_mm;
        CHECK((x >= before && x <= 40.0));
        before = x;
    }
    CHECK(t.position(86400.0) == point{40.0, 10.0});
    CHECK(t.position(std::numeric_limits<double>::quiet_NaN()) == point{0.0, 10.0});
    CHECK(t.meets_x(20.0).size() == 1);
}

TEST_CASE("impossible movements are refused")
{
    const double nan_value = std::numeric_limits<double>::quiet_NaN();
    CHECK(refusal({.speed_mm_s = {{0.5, 10.0}, {0.5, 20.0}}}) ==
          "speed_mm_s: point 2: part 0.5 is not after the previous one, 0.5 (put parts in ascending order)");
    CHECK(refusal({.speed_mm_s = {{0.0, 0.0}}}).find("speed_mm_s: point 1: 0") == 0);
    CHECK(refusal({.speed_mm_s = {{1.1, 1.0}}}).find("speed_mm_s: point 1: part 1.1") == 0);
    CHECK(refusal({.speed_mm_s = {{nan_value, 1.0}}}).find("speed_mm_s: point 1: part nan") == 0);
    CHECK(refusal({.intensity = {{0.0, -0.5}}}).find("intensity: point 1: -0.5") == 0);
    CHECK(refusal({.intensity = {{0.0, nan_value}}}).find("intensity: point 1: nan") == 0);
    CHECK(refusal({.rests = {{0.5, 0.0}}}).find("pauses: point 1: 0") == 0);
    CHECK(refusal({.rests = {{0.5, 1.0, 1.5}}}).find("pauses: intensity 1.5") == 0);
    CHECK(
        refusal({.duration_s = 1.0, .rests = {{0.5, 0.5}, {0.6, 0.5}}}).find("pauses: their total of 1 s") ==
        0);
    CHECK(refusal({.duration_s = 0.0}).find("duration_s: 0 s") == 0);
    CHECK(refusal({.rests = {{0.5, 86400.0}}}).find("duration_s: ") == 0);
    CHECK(refusal({.speed_mm_s = {{0.5, 1e-6}}}).find("duration_s: ") == 0);
    for (const double v : {0.0, -1.0, nan_value, std::numeric_limits<double>::infinity()})
        CHECK_THROWS_AS(trajectory::along(line, 1.0).with_speed(v), error);
}

TEST_CASE("lengths are those of std::hypot, to the last digit but one on every machine")
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 200'000; ++i) {
        const double x = std::ldexp(unit(random), static_cast<int>(random() % 60) - 30);
        const double y = i % 2 == 0 ? unit(random) : x * (1.0 + 1e-9 * unit(random));
        const double exact =
            static_cast<double>(std::hypot(static_cast<long double>(x), static_cast<long double>(y)));
        const double h = detail::portable_hypot(x, y);
        REQUIRE(h >= std::nextafter(exact, 0.0));
        REQUIRE(h <= std::nextafter(exact, HUGE_VAL));
        REQUIRE(h == detail::portable_hypot(-y, x));
    }
}

TEST_CASE("lengths of zero, of squares beyond the range, and of non-numbers")
{
    constexpr double huge = 1e300;
    constexpr double tiny = 1e-300;
    CHECK(detail::portable_hypot(0.0, 0.0) == 0.0);
    CHECK(detail::portable_hypot(0.0, -7.0) == 7.0);
    CHECK(detail::portable_hypot(3.0, 4.0) == 5.0);
    CHECK(detail::portable_hypot(3.0 * huge, 4.0 * huge) == std::hypot(3.0 * huge, 4.0 * huge));
    CHECK(detail::portable_hypot(3.0 * tiny, 4.0 * tiny) == std::hypot(3.0 * tiny, 4.0 * tiny));
    CHECK(std::isinf(detail::portable_hypot(HUGE_VAL, 1.0)));
    CHECK(std::isnan(detail::portable_hypot(std::numeric_limits<double>::quiet_NaN(), 1.0)));
    CHECK(detail::length_mm({1.0, 2.0}, {4.0, 6.0}) == 5.0);
}

} // namespace movement_test
