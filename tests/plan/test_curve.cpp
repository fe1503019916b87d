// SPDX-License-Identifier: MIT
// Curves of continuous strokes, and carriers that change along the path.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "plan/job.hpp"
#include "strokes.hpp"

namespace curve_test {

using namespace tactor;
using namespace tactor::test;

namespace {

plan flowing(double duration_s)
{
    stroke s = preset_stroke("park2016-3");
    s.motion = s.motion.with_duration(duration_s);
    return make_plan(palm, s, continuous());
}

curve_samples read_samples(const curve& c)
{
    curve_samples all;
    burst b;
    for (std::uint64_t k = 0; k < c.size(); ++k) {
        c.sample(k, b);
        all.add(b);
    }
    return all;
}

struct counting final : phantom_model {
    mutable std::uint64_t asked = 0;
    std::string_view name() const noexcept override { return "mine"; }
    void weights(point, double a_v, std::vector<drive>& out) const override
    {
        ++asked;
        out = {{4, 0.5 * a_v}};
    }
};

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
    const recording sine{"x.wav", 8000.0, {0.0F, 1.0F, 0.0F, -1.0F}};
    s.sound.wave = {.kind = waveform_kind::recording,
                    .recorded = std::make_shared<const recording>(sine),
                    .texture = texture_kind::length,
                    .texture_mm = length_mm / 4.0};
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

TEST_CASE("a curve has a sample each millisecond and one at its end")
{
    for (const auto& [duration, samples] :
         {std::pair{1.4, 1401U}, {0.0004, 2U}, {1.4002, 1402U}, {7.0, 7001U}}) {
        CAPTURE(duration);
        const plan p = flowing(duration);
        REQUIRE(p.curve);
        CHECK(p.curve->size() == samples);
        CHECK(p.curve->duration_s() == duration);
        burst b;
        p.curve->sample(samples - 1, b);
        CHECK(b.onset_s == doctest::Approx(duration).epsilon(1e-12));
        burst beyond;
        p.curve->sample(samples + 7, beyond);
        CHECK(beyond == b);
    }
}

TEST_CASE("a sample replaces the whole of a burst")
{
    for (const double duration : {1.4, 7.0}) { // kept, and computed
        const plan p = flowing(duration);
        burst fresh;
        p.curve->sample(700, fresh);
        burst used = make_plan(palm, preset_stroke("park2016-1")).bursts[3];
        used.tau_s = 0.1;
        p.curve->sample(700, used);
        CHECK(used == fresh);
        CHECK(used.duration_s == 0.0);
        CHECK_FALSE(used.tau_s);
        used.duration_s = 0.07;
        used.tau_s = 0.1;
        p.curve->at(0.7, used);
        CHECK(used == fresh);
        used.duration_s = 0.07;
        used.tau_s = 0.1;
        p.curve->at(0.70025, used);
        CHECK(used.duration_s == 0.0);
        CHECK_FALSE(used.tau_s);
    }
}

TEST_CASE("a plan made again from its samples is the same plan, short or long")
{
    for (const double duration : {0.01, 1.4, 3.9995, 5.0, 12.3456}) {
        CAPTURE(duration);
        const plan p = flowing(duration);
        plan again = p;
        again.curve = curve(duration, read_samples(*p.curve));
        CHECK(again == p);
        CHECK(p == flowing(duration));
        CHECK(p != flowing(duration + 0.001));

        curve_samples other = read_samples(*p.curve);
        other.drives.back().amplitude = std::nextafter(other.drives.back().amplitude, 2.0);
        again.curve = curve(duration, other);
        CHECK(again != p);
        again.curve.reset();
        CHECK(again != p);
    }
    const plan bursts = make_plan(palm, preset_stroke("park2016-3"));
    CHECK(bursts == make_plan(palm, preset_stroke("park2016-3")));
    CHECK(bursts != make_plan(palm, preset_stroke("park2016-4")));
}

TEST_CASE("a curve is linear between samples, as it sounds")
{
    curve_samples s;
    burst b{.position = {0.0, 10.0}};
    b.drives = {{0, 0.5}, {3, 0.25}};
    s.add(b);
    b.position = {4.0, 10.0};
    b.intensity = 3.0;
    b.drives = {{3, 0.75}, {8, 1.0}};
    s.add(b);
    const curve c(0.001, s);
    c.at(0.00025, b);
    CHECK(b.onset_s == 0.00025);
    CHECK(b.position == point{1.0, 10.0});
    CHECK(b.intensity == 1.5);
    CHECK(b.drives == std::vector<drive>{{0, 0.375}, {3, 0.375}, {8, 0.25}});
    c.at(1e-10, b); // a nanosecond changes nothing
    CHECK(b.drives.size() == 2);
    c.at(5.0, b);
    CHECK(b.drives == std::vector<drive>{{3, 0.75}, {8, 1.0}});
    c.at(std::numeric_limits<double>::quiet_NaN(), b);
    CHECK(b.position == point{0.0, 10.0});
}

TEST_CASE("a custom model is asked when the stroke is planned, once for each sample")
{
    const auto mine = std::make_shared<counting>();
    plan_options o = continuous();
    o.custom_phantom = mine;
    stroke s = preset_stroke("park2016-1");
    const plan p = make_plan(palm, s, o);
    CHECK(mine->asked == 1401);
    burst b;
    p.curve->at(0.7, b);
    CHECK(b.drives == std::vector<drive>{{4, 0.5}});
    CHECK(p.phantom == "mine");
    CHECK(mine->asked == 1401);
    s.motion = s.motion.with_duration(20000.0);
    has(caught_message([&] { return make_plan(palm, s, o); }), "2e+07 samples of phantom model \"mine\"");
    CHECK(mine->asked == 1401);
}

TEST_CASE("impossible samples of a curve are refused")
{
    const curve_samples good = read_samples(*flowing(0.01).curve);
    const auto refused = [](double duration_s, const curve_samples& s) {
        return caught_message([&] { curve(duration_s, s); });
    };
    CHECK(refused(0.01, good).empty());
    for (const double duration : {0.0, -1.0, HUGE_VAL, std::nan(""), 86401.0})
        CHECK(refused(duration, good).find("curve: it lasts") == 0);
    CHECK(caught_field([&] { curve(0.0, good); }) == "duration_s");
    CHECK(refused(0.011, good).find("0.011 s needs 12 samples") != std::string::npos);
    const auto with = [&](auto change) {
        curve_samples s = good;
        change(s);
        return refused(0.01, s);
    };
    has(with([](curve_samples& s) { s.positions[3].x_mm = std::nan(""); }), "sample 3");
    has(with([](curve_samples& s) { s.intensities[4] = HUGE_VAL; }), "sample 4");
    has(with([](curve_samples& s) { s.drives[0].amplitude = std::nan(""); }), "sample 0");
    has(with([](curve_samples& s) { s.ends[2] = 0; }), "sample 2");
    has(with([](curve_samples& s) { s.ends.back() += 1; }), "sample 10");
    has(with([](curve_samples& s) { s.ends.pop_back(); }), "10 drive ends");
    has(with([](curve_samples& s) { std::swap(s.drives[0], s.drives[1]); }), "after tactor");
}

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

TEST_CASE("a carrier profile ascends along the path and holds carriers")
{
    stroke s = moving(eased);
    s.sound.carrier_profile = {{0.5, 100.0}, {0.5, 200.0}};
    has(refusal(palm, s, {}), "carrier_profile: part 0.5 is out of order or range");
    s.sound.carrier_profile = {{0.5, 0.5}};
    has(refusal(palm, s, {}), "not a carrier");
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

} // namespace curve_test
