// SPDX-License-Identifier: MIT
// Carriers and recordings along the path, with targets that ease, change their speed and rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include "plan/job.hpp"
#include "strokes.hpp"

namespace course_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr double length_mm = 40.0;
constexpr double rest_s = 0.6;

const movement eased{.duration_s = 2.0, .easing = easing_kind::in_out};
const movement jerk{.duration_s = 2.0, .easing = easing_kind::minimum_jerk};
const movement ever_faster{.duration_s = 1.5, .speed_mm_s = {{0.0, 1.0}, {1.0, 1000.0}}};
const movement two_speeds{.speed_mm_s = {{0.0, 20.0}, {0.3, 20.0}, {0.31, 80.0}}};
const movement resting{.duration_s = 3.0,
                       .easing = easing_kind::in_out,
                       .speed_mm_s = {{0.0, 1.0}, {1.0, 2.0}},
                       .rests = {{0.4, rest_s, 0.0}}};
const movement at_ends{.duration_s = 2.0, .rests = {{0.0, 0.5}, {1.0, 0.25}}};

stroke moving(const movement& m)
{
    return make_stroke(trajectory::along(path::from_svg("M 0 20 H 40"), m));
}

std::vector<stroke> strokes()
{
    std::vector<stroke> all;
    for (const movement& m : {eased, jerk, ever_faster, two_speeds, resting, at_ends}) {
        const stroke s = moving(m);
        all.push_back(s);
        all.push_back(make_stroke(s.motion.with_duration(0.7)));
        all.push_back(make_stroke(s.motion.reversed()));
    }
    return all;
}

std::vector<carrier_point> carrier_points(const stroke& s)
{
    return make_plan(palm, s, {.algorithm = algorithm_kind::continuous}).course;
}

/// Returns the course of a recording along the path by its length, four times.
std::vector<carrier_point> texture_points(stroke s)
{
    waveform w;
    w.kind = waveform_kind::recording;
    w.texture = texture_kind::length;
    w.texture_mm = length_mm / 4.0;
    w.recorded = std::make_shared<const recording>(recording{"x.wav", 8000.0, {0.0F, 1.0F, 0.0F, -1.0F}});
    s.sound.wave = w;
    return carrier_points(s);
}

/// Returns the part of the path behind the target.
double part(const stroke& s, double t_s)
{
    return std::abs(s.motion.position(t_s).x_mm - s.motion.position(0.0).x_mm) / length_mm;
}

double hz_at(const std::vector<carrier_point>& course, double t_s)
{
    const auto after = std::find_if(course.begin() + 1, course.end() - 1,
                                    [t_s](const carrier_point& c) { return c.t_s > t_s; });
    const carrier_point& before = *(after - 1);
    return detail::hz_between(before, *after, (t_s - before.t_s) / (after->t_s - before.t_s));
}

/// Returns the cycles from a point to a part u of the time to the next, by tactor-json(5).
long double cycles(const carrier_point& a, const carrier_point& b, long double u)
{
    const auto& k = a.bend;
    const std::array<long double, 6> hz{a.hz,
                                        static_cast<long double>(b.hz) - a.hz + k[0],
                                        static_cast<long double>(k[1]) - k[0],
                                        static_cast<long double>(k[2]) - k[1],
                                        static_cast<long double>(k[3]) - k[2],
                                        -k[3]};
    long double sum = 0.0L;
    for (std::size_t i = hz.size(); i-- > 0;)
        sum = u * (hz[i] / static_cast<long double>(i + 1) + sum);
    return sum * (static_cast<long double>(b.t_s) - a.t_s);
}

/// Returns the cycles until a time.
double rounds(const std::vector<carrier_point>& course, double t_s)
{
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < course.size() && course[i].t_s < t_s; ++i) {
        const carrier_point& a = course[i];
        const carrier_point& b = course[i + 1];
        if (b.t_s > a.t_s) {
            const double end_s = std::min(b.t_s, t_s);
            const double hz = std::lerp(a.hz, b.hz, (end_s - a.t_s) / (b.t_s - a.t_s));
            sum += 0.5 * (a.hz + hz) * (end_s - a.t_s);
        }
    }
    return sum;
}

double greatest_hz(const std::vector<carrier_point>& course)
{
    double most = 0.0;
    for (const carrier_point& c : course)
        most = std::max(most, c.hz);
    return most;
}

} // namespace

TEST_CASE("the carrier is that of the covered part of the path")
{
    for (stroke s : strokes()) {
        s.sound.carrier_profile = {{0.2, 100.0}, {0.7, 300.0}};
        const auto course = carrier_points(s);
        const double end_s = s.motion.duration_s();
        CHECK(course.front().t_s == 0.0);
        CHECK(course.back().t_s == end_s);
        double worst = 0.0;
        for (int i = 0; i <= 1000; ++i) {
            const double t_s = end_s * i / 1000.0;
            const double wanted = 100.0 + 400.0 * (std::clamp(part(s, t_s), 0.2, 0.7) - 0.2);
            worst = std::max(worst, std::abs(hz_at(course, t_s) - wanted));
        }
        CHECK(worst < 1e-8);
    }
}

TEST_CASE("the carrier's cycles are the integral of its frequency, even over an hour")
{
    for (const double duration_s : {2.0, 3600.0})
        for (stroke s : strokes()) {
            s.motion = s.motion.with_duration(duration_s);
            s.sound.carrier_profile = {{0.2, 60.0}, {0.7, 300.0}};
            const auto course = carrier_points(s);
            // By Gauss and Legendre, from point to point in many pieces, and at each of them.
            constexpr int pieces = 50;
            long double wanted = 0.0;
            long double given = 0.0;
            long double worst = 0.0;
            for (std::size_t i = 0; i + 1 < course.size(); ++i) {
                const carrier_point& a = course[i];
                const carrier_point& b = course[i + 1];
                const double step_s = (b.t_s - a.t_s) / pieces;
                for (int k = 0; k < pieces; ++k) {
                    for (const double place : {-0.7745966692414834, 0.0, 0.7745966692414834}) {
                        const double t_s = a.t_s + step_s * (k + 0.5 + 0.5 * place);
                        const long double hz = 60.0L + 480.0L * (std::clamp(part(s, t_s), 0.2, 0.7) - 0.2L);
                        wanted += hz * step_s * (place == 0.0 ? 8.0L : 5.0L) / 18.0L;
                    }
                    const long double u = static_cast<long double>(k + 1) / pieces;
                    worst = std::max(worst, std::abs(wanted - given - cycles(a, b, u)));
                }
                given += cycles(a, b, 1.0L);
            }
            CHECK(static_cast<double>(worst) < 1e-9);
        }
}

TEST_CASE("a recording along the path is where the target is, at every time")
{
    for (const stroke& s : strokes()) {
        const auto course = texture_points(s);
        const double end_s = s.motion.duration_s();
        CHECK(course.back().t_s == end_s);
        double worst = 0.0;
        for (int i = 0; i <= 1000; ++i)
            worst = std::max(
                worst, std::abs(rounds(course, end_s * i / 1000.0) / 4.0 - part(s, end_s * i / 1000.0)));
        CHECK(worst < 1e-4);
        CHECK(rounds(course, end_s) == doctest::Approx(4.0));
    }
    CHECK(greatest_hz(texture_points(moving(jerk))) == doctest::Approx(1.875 * 2.0).epsilon(0.02));
    CHECK(greatest_hz(texture_points(moving(eased))) == doctest::Approx(1.5 * 2.0).epsilon(0.02));
}

TEST_CASE("where the target rests a recording along the path stays, and the carrier is held")
{
    stroke s = moving(resting);
    const auto silent_s = [](const std::vector<carrier_point>& course) {
        double sum = 0.0;
        for (std::size_t i = 0; i + 1 < course.size(); ++i)
            if (course[i].hz == 0.0 && course[i + 1].hz == 0.0)
                sum += course[i + 1].t_s - course[i].t_s;
        return sum;
    };
    CHECK(silent_s(texture_points(s)) == doctest::Approx(rest_s));
    CHECK(silent_s(texture_points(moving(at_ends))) == doctest::Approx(0.75));
    CHECK(silent_s(texture_points(moving(jerk))) == 0.0);
    s.sound.carrier_profile = {{0.0, 100.0}, {1.0, 200.0}};
    double held_s = 0.0;
    const auto course = carrier_points(s);
    for (std::size_t i = 0; i + 1 < course.size(); ++i)
        if (course[i].hz == course[i + 1].hz) {
            CHECK(course[i].hz == doctest::Approx(140.0));
            held_s += course[i + 1].t_s - course[i].t_s;
        }
    CHECK(held_s == doctest::Approx(rest_s));
}

TEST_CASE("a course has as many points as its bends need")
{
    stroke s = moving({.duration_s = 2.0, .intensity = {{0.0, 0.2}, {1.0, 0.8}}});
    s.sound.carrier_profile = {{0.0, 100.0}, {1.0, 200.0}};
    CHECK(carrier_points(s) == std::vector<carrier_point>{{0.0, 100.0}, {2.0, 200.0}});
    s.motion = moving(at_ends).motion;
    CHECK(carrier_points(s) ==
          std::vector<carrier_point>{{0.0, 100.0}, {0.5, 100.0}, {1.75, 200.0}, {2.0, 200.0}});
    for (stroke t : strokes()) {
        t.sound.carrier_profile = s.sound.carrier_profile;
        CHECK(carrier_points(t).size() < 600);
    }
}

TEST_CASE("points with almost equal times make no impossible frequency")
{
    // With another duration the second and the third are at the same time.
    const double next = std::nextafter(1.0, 2.0);
    REQUIRE(1.0 / 7.0 * 0.111 == next / 7.0 * 0.111);
    stroke s = timed({{0.0, {0, 20}}, {1.0, {10, 20}}, {next, {11, 20}}, {7.0, {40, 20}}});
    s.motion = s.motion.with_duration(0.111);
    const auto course = texture_points(s);
    for (const carrier_point& c : course)
        CHECK(std::isfinite(c.hz));
    CHECK(rounds(course, 0.111) == doctest::Approx(4.0));
}

} // namespace course_test
