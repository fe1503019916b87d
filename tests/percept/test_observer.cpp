// SPDX-License-Identifier: MIT
// The low-speed observer, and bursts moved for it.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>

#include "../plan/arrays.hpp"
#include "../plan/strokes.hpp"
#include "rounds.hpp"

namespace observer_test {

using namespace tactor;
using namespace tactor::test;

namespace {

tap_summary of_motion(phantom_kind phantom, double sigma_mm, point* first = nullptr)
{
    const stroke s = preset_stroke("park2016-1");
    const plan p = make_plan(palm, s, {.phantom = phantom});
    const std::vector<tap> taps = predict_taps(palm, s, p, {sigma_mm, 100.0});
    REQUIRE(taps.size() == 21);
    if (first != nullptr)
        *first = taps.front().felt;
    return summarise(taps);
}

void close(double got, double expected)
{
    CHECK(std::abs(got - expected) <= 5e-7);
}

/// Solves the same system by Gauss's elimination in long double, with the matrix written out.
std::vector<point> by_elimination(const low_speed_observer& o, const std::vector<double>& t,
                                  std::vector<point> m)
{
    const std::size_t n = t.size();
    std::vector<std::vector<long double>> a(n, std::vector<long double>(n, 0.0L));
    for (std::size_t i = 0; i < n; ++i)
        a[i][i] += 1.0L;
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const long double k = std::pow(static_cast<long double>(o.sigma_mm) /
                                           (static_cast<long double>(o.sigma_v_mm_s) * (t[i + 1] - t[i])),
                                       2.0L);
        a[i][i] += k;
        a[i + 1][i + 1] += k;
        a[i][i + 1] -= k;
        a[i + 1][i] -= k;
    }
    std::vector<long double> x(n), y(n);
    for (std::size_t i = 0; i < n; ++i) {
        x[i] = m[i].x_mm;
        y[i] = m[i].y_mm;
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t r = i + 1; r < n; ++r) {
            const long double f = a[r][i] / a[i][i];
            for (std::size_t c = i; c < n; ++c)
                a[r][c] -= f * a[i][c];
            x[r] -= f * x[i];
            y[r] -= f * y[i];
        }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t c = i + 1; c < n; ++c) {
            x[i] -= a[i][c] * x[c];
            y[i] -= a[i][c] * y[c];
        }
        x[i] /= a[i][i];
        y[i] /= a[i][i];
        m[i] = {static_cast<double>(x[i]), static_cast<double>(y[i])};
    }
    return m;
}

std::string refused(const low_speed_observer& o, const std::vector<double>& t, const std::vector<point>& m)
{
    return caught_message([&] { static_cast<void>(felt_places(o, t, m)); });
}

std::vector<double> onsets(std::size_t n, double soa_s)
{
    std::vector<double> t(n);
    for (std::size_t i = 0; i < n; ++i)
        t[i] = soa_s * static_cast<double>(i);
    return t;
}

double cost(const std::vector<point>& felt, const std::vector<point>& targets)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < felt.size(); ++i)
        sum += std::pow(distance_mm(felt[i], targets[i]), 2.0);
    return sum;
}

point blend(point a, point b, double u)
{
    return {a.x_mm + u * (b.x_mm - a.x_mm), a.y_mm + u * (b.y_mm - a.y_mm)};
}

/// Finds the least cost in another way: projected gradients with momentum (Beck and Teboulle 2009), restarted
/// where they climb, using only felt_places() and the nearest point of the array.
double by_gradients(const layout& l, const low_speed_observer& o, const std::vector<double>& t,
                    const std::vector<point>& x, int steps)
{
    std::vector<point> m(x.size(), l.places().front());
    std::vector<point> ahead = m;
    double momentum = 1.0;
    double best = 1e300;
    for (int i = 0; i < steps; ++i) {
        std::vector<point> r = felt_places(o, t, ahead);
        for (std::size_t k = 0; k < r.size(); ++k)
            r[k] = {r[k].x_mm - x[k].x_mm, r[k].y_mm - x[k].y_mm};
        const std::vector<point> slope = felt_places(o, t, r); // the inverse of I + K is symmetric
        std::vector<point> next(x.size());
        for (std::size_t k = 0; k < r.size(); ++k)
            next[k] = l.nearest({ahead[k].x_mm - slope[k].x_mm, ahead[k].y_mm - slope[k].y_mm});
        const double now = cost(felt_places(o, t, next), x);
        const double later = now > best ? 1.0 : (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum)) / 2.0;
        for (std::size_t k = 0; k < r.size(); ++k)
            ahead[k] = blend(m[k], next[k], 1.0 + (later > 1.0 ? (momentum - 1.0) / later : 0.0));
        momentum = later;
        m = next;
        best = std::min(best, now);
    }
    return best;
}

compensated_plan of_motion(const char* name, phantom_kind phantom, const low_speed_observer& m = {},
                           algorithm_kind algorithm = algorithm_kind::park2016)
{
    return make_compensated_plan(palm, layout(palm), preset_stroke(name),
                                 {.algorithm = algorithm, .phantom = phantom}, m);
}

} // namespace

TEST_CASE("two taps: the closed form")
{
    for (const double sigma : {0.5, 5.0, 10.0, 80.0})
        for (const double t : {0.001, 0.0473, 0.07, 0.3, 5.0})
            for (const double l : {1.0, 20.0, 100.0}) {
                const double k = std::pow(sigma / (100.0 * t), 2.0);
                const std::vector<point> x =
                    felt_places({sigma, 100.0}, {{0.0, t}}, {{{3.0, -l}, {3.0, 0.0}}});
                CHECK(std::abs(distance_mm(x[0], x[1]) - l / (1.0 + 2.0 * k)) <= 1e-12);
                CHECK(std::abs(x[0].y_mm + x[1].y_mm + l) <= 1e-12 * l); // about the same middle
                CHECK(x[0].x_mm == doctest::Approx(3.0).epsilon(1e-14));
            }
}

TEST_CASE("check values of the rendering model")
{
    point first;
    tap_summary r = of_motion(phantom_kind::inverse_distance, 5.0, &first);
    close(*r.length_ratio, 0.950220);
    close(*r.rms_error_mm, 1.066995);
    close(*r.largest_error_mm, 1.805183);
    close(first.x_mm, 18.938236);
    close(first.y_mm, 4.039318);
    r = of_motion(phantom_kind::inverse_distance, 10.0, &first);
    close(*r.length_ratio, 0.864855);
    close(*r.rms_error_mm, 1.191315);
    close(*r.largest_error_mm, 2.502074);
    close(first.x_mm, 17.532127);
    close(first.y_mm, 4.412288);
    r = of_motion(phantom_kind::barycentric, 5.0);
    close(*r.length_ratio, 0.952086);
    close(*r.rms_error_mm, 0.346916);
    close(*r.largest_error_mm, 0.927908);

    // 40 mm at 200 mm/s: three bursts, at 0, 14 and 28 mm.
    const stroke s = along("M 0 20 L 40 20", 0.2);
    for (const auto& [sigma, ratio] : {std::pair{5.0, 0.662162}, std::pair{10.0, 0.328859}}) {
        const tap_summary line = summarise(predict_taps(palm, s, make_plan(palm, s), {sigma, 100.0}));
        CHECK(line.target_length_mm == doctest::Approx(28.0).epsilon(1e-12));
        close(*line.length_ratio, ratio);
    }
}

TEST_CASE("any chain solves its equations, for any onsets")
{
    generator g(7);
    for (int round = 0; round < 200; ++round) {
        const low_speed_observer o{between(g, 0.1, 20.0), between(g, 10.0, 500.0)};
        std::vector<double> t{0.0};
        std::vector<point> m;
        const unsigned n = pick(g, 1, 40);
        while (t.size() < n)
            t.push_back(t.back() + between(g, 0.005, 0.4));
        for (unsigned i = 0; i < n; ++i)
            m.push_back({between(g, -50.0, 50.0), between(g, -50.0, 50.0)});
        const std::vector<point> x = felt_places(o, t, m);
        const std::vector<point> y = by_elimination(o, t, m);
        REQUIRE(x.size() == n);
        for (unsigned i = 0; i < n; ++i)
            REQUIRE(distance_mm(x[i], y[i]) < 1e-10);
    }
}

TEST_CASE("simultaneous taps are felt at one place, and taps far apart in time at their own")
{
    const std::vector<point> m{{0.0, 0.0}, {10.0, 2.0}, {40.0, -2.0}};
    const std::vector<point> x = felt_places({}, {{1.0, 1.0, 1.0}}, m);
    for (const point& p : x) {
        CHECK(p.x_mm == doctest::Approx(50.0 / 3.0).epsilon(1e-14));
        CHECK(std::abs(p.y_mm) < 1e-14);
    }
    for (const double apart_s : {1e6, 1e300}) {
        const std::vector<point> y = felt_places({}, {{0.0, apart_s, 3.0 * apart_s}}, m);
        for (std::size_t i = 0; i < m.size(); ++i)
            CHECK(distance_mm(y[i], m[i]) < 1e-9);
    }
    // A chain as rigid as possible: nothing cancels.
    const std::vector<point> z = felt_places({most_sigma_mm, least_sigma_v_mm_s}, {{0.0, 1e-9, 2e-9}}, m);
    CHECK(z[1].x_mm == doctest::Approx(50.0 / 3.0).epsilon(1e-12));
    CHECK(felt_places({}, {}, {}).empty());
    CHECK(felt_places({}, {{0.5}}, {{{1.0, 2.0}}}).front() == point{1.0, 2.0});
}

TEST_CASE("a hundred thousand taps are solved exactly")
{
    const std::size_t n = 100'000;
    std::vector<point> m(n);
    for (std::size_t i = 0; i < n; ++i)
        m[i] = {20.0 + 16.0 * std::cos(0.1 * static_cast<double>(i)), i % 2 == 0 ? 0.0 : 40.0};
    const std::vector<point> x = felt_places({}, onsets(n, 0.07), m);
    const double k = std::pow(5.0 / 7.0, 2.0);
    double worst = 0.0;
    for (std::size_t i = 1; i + 1 < n; ++i) // the equation itself, onsets being equal to rounding
        worst = std::max(
            worst, std::abs((1.0 + 2.0 * k) * x[i].y_mm - k * (x[i - 1].y_mm + x[i + 1].y_mm) - m[i].y_mm));
    CHECK(worst < 1e-8);
}

TEST_CASE("silent bursts are not felt; the target counts at the onset")
{
    const stroke s = timed({{0.0, {0.0, 0.0}, 1.0}, {0.07, {10.0, 0.0}, 0.0}, {0.14, {20.0, 0.0}, 1.0}});
    const plan p = make_plan(palm, s);
    REQUIRE(p.bursts.size() == 3);
    const std::vector<tap> taps = predict_taps(palm, s, p);
    REQUIRE(taps.size() == 2);
    CHECK(taps[1].onset_s == doctest::Approx(0.14));
    CHECK(distance_mm(taps[1].target, {20.0, 0.0}) < 1e-9);
    CHECK(distance_mm(taps[1].alone, {20.0, 0.0}) < 1e-9);
    const double k = std::pow(5.0 / 14.0, 2.0);
    CHECK(distance_mm(taps[0].felt, taps[1].felt) == doctest::Approx(20.0 / (1.0 + 2.0 * k)).epsilon(1e-12));
    const tap_summary none = summarise(std::vector<tap>{});
    CHECK_FALSE(none.rms_error_mm);
    CHECK_FALSE(none.length_ratio);
}

TEST_CASE("another person's taps are shifted before they are pulled together")
{
    const stroke s = along("M 0 20 L 40 20", 0.2);
    const plan p = make_plan(palm, s);
    person who;
    who.shift.assign(9, {1.5, -0.5});
    const std::vector<tap> usual = predict_taps(palm, s, p);
    const std::vector<tap> moved = predict_taps(palm, s, p, {}, who);
    for (std::size_t i = 0; i < usual.size(); ++i) {
        CHECK(moved[i].target == usual[i].target);
        CHECK(moved[i].felt.x_mm - usual[i].felt.x_mm == doctest::Approx(1.5).epsilon(1e-9));
        CHECK(moved[i].felt.y_mm - usual[i].felt.y_mm == doctest::Approx(-0.5).epsilon(1e-9));
    }
    who.shift.pop_back();
    CHECK_THROWS_WITH_AS(predict_taps(palm, s, p, {}, who), doctest::Contains("shift"), error);
}

TEST_CASE("impossible predictions and parameters are refused")
{
    const stroke s = preset_stroke("park2016-1");
    CHECK_THROWS_WITH_AS(predict_taps(palm, s, make_plan(palm, s, continuous())),
                         doctest::Contains("continuous"), error);
    plan elsewhere = make_plan(palm, s);
    elsewhere.bursts[3].drives.back().tactor = 9;
    CHECK_THROWS_WITH_AS(predict_taps(palm, s, elsewhere), doctest::Contains("tactor 9"), error);
    const std::vector<point> m{{0.0, 0.0}, {1.0, 0.0}};
    for (const double bad : {0.0, -5.0, 1e9, not_a_number, infinite}) {
        CHECK(refused({bad, 100.0}, {0.0, 0.1}, m).find("sigma_mm") == 0);
        CHECK(refused({5.0, bad}, {0.0, 0.1}, m).find("sigma_v_mm_s") == 0);
    }
    CHECK(refused({}, {0.1, 0.0}, m).find("order") != std::string::npos);
    CHECK(refused({}, {0.0, not_a_number}, m).find("onsets_s") == 0);
    CHECK(refused({}, {0.0}, m).find("onsets_s") == 0);
    CHECK(refused({}, {0.0, 0.1}, {{0.0, 0.0}, {infinite, 0.0}}).find("finite") != std::string::npos);
}

TEST_CASE("the description of its numbers names model, parameters and purpose")
{
    const std::string text = describe({7.5, 120.0});
    for (const char* word : {"low-speed", "Goldreich", "7.5 mm", "120 mm/s", "taps", "nobody has fitted"})
        CHECK(text.find(word) != std::string::npos);
    CHECK(from_string<observer_kind>("low-speed") == observer_kind::low_speed);
    CHECK(all_values<observer_kind>().size() == 2);
}

TEST_CASE("inside the array the target itself is felt")
{
    const array wide = make_grid("wide", 5, 5, 20.0, 20.0);
    const plan_options o{.phantom = phantom_kind::barycentric};
    for (const double sigma : {2.0, 5.0, 10.0}) {
        const stroke s = along("M 30 40 A 10 10 0 0 0 50 40", 1.0);
        const compensated_plan p = make_compensated_plan(wide, layout(wide), s, o, {sigma, 100.0});
        CHECK(p.at_edge == 0);
        CHECK(p.residual_largest_mm < 1e-9);
        const tap_summary felt = summarise(predict_taps(wide, s, p.plan, {sigma, 100.0}));
        CHECK(*felt.largest_error_mm < 1e-6);
        CHECK(*felt.length_ratio == doctest::Approx(1.0).epsilon(1e-9));
        // It is another plan: without it, the observer is off.
        CHECK(*summarise(predict_taps(wide, s, make_plan(wide, s, o), {sigma, 100.0})).largest_error_mm >
              0.1);
    }
}

TEST_CASE("two taps by hand: at the edge as far as possible")
{
    // A pair of tactors 10 mm apart, targets at 1 and 9 mm, k = 1/2: 8 mm are felt of 16 mm, of which 10 fit;
    // they are felt 5 mm apart, 1.5 mm short on each side.
    const layout l(make_array({{0.0, 0.0}, {10.0, 0.0}}));
    const low_speed_observer o{5.0, 100.0};
    const double t = 0.05 * std::sqrt(2.0);
    const compensated_places p = compensate(l, o, {{0.0, t}}, {{{1.0, 3.0}, {9.0, -4.0}}});
    CHECK(p.at_edge == 2);
    CHECK(distance_mm(p.played[0], {0.0, 0.0}) < 1e-9);
    CHECK(distance_mm(p.played[1], {10.0, 0.0}) < 1e-9);
    CHECK(distance_mm(p.felt[0], {2.5, 0.0}) < 1e-9);
    CHECK(distance_mm(p.felt[1], {7.5, 0.0}) < 1e-9);
    const compensated_places free = compensate(l, o, {{0.0, t}}, {{{3.0, 0.0}, {7.0, 0.0}}});
    CHECK(free.at_edge == 0);
    CHECK(distance_mm(free.played[0], {1.0, 0.0}) < 1e-12);
    const compensated_places one =
        compensate(layout(make_array({{2.0, 3.0}})), o, {{0.0, t}}, {{{1.0, 3.0}, {9.0, 4.0}}});
    CHECK(one.played[1] == point{2.0, 3.0});
    CHECK(one.at_edge == 2);
    const compensated_places alone = compensate(l, o, {{0.0}}, {{{12.0, 1.0}}});
    CHECK(alone.at_edge == 1);
    CHECK(distance_mm(alone.played[0], {10.0, 0.0}) < 1e-9);
}

TEST_CASE("at the edge no other way finds places that are felt nearer")
{
    generator g(20);
    int at_edge = 0;
    for (int round = 0; round < rounds(96); ++round) {
        const array a = some_array(g, static_cast<unsigned>(round) % kinds_of_array);
        const layout l(a);
        const low_speed_observer o{between(g, 1.0, 12.0), between(g, 60.0, 200.0)};
        const unsigned n = pick(g, 1, 25);
        std::vector<double> t{0.0};
        std::vector<point> x;
        while (t.size() < n)
            t.push_back(t.back() + between(g, 0.05, 0.2));
        for (unsigned i = 0; i < n; ++i)
            x.push_back(some_point(g, l));
        const compensated_places p = compensate(l, o, t, x);
        at_edge += p.at_edge != 0 ? 1 : 0;
        for (const point& m : p.played)
            REQUIRE(l.contains(m));
        const std::vector<point> felt = felt_places(o, t, p.played);
        for (unsigned i = 0; i < n; ++i)
            REQUIRE(distance_mm(felt[i], p.felt[i]) < 1e-9);
        CAPTURE(round);
        const double ours = cost(p.felt, x);
        const double theirs = by_gradients(l, o, t, x, 4000);
        CHECK(ours <= theirs + 1e-6);
        CHECK(theirs <= ours + 1e-3 * (1.0 + ours)); // both minimise the same cost
    }
    CHECK(at_edge > rounds(40));
}

// Circles 0.1 mm inside the edge, 20 taps each; they are felt far inside, so most are played at the edge.
std::vector<point> circles(std::size_t taps)
{
    std::vector<point> x;
    for (std::size_t i = 0; i < taps; ++i) {
        const double turn = 2.0 * std::numbers::pi * 0.05 * static_cast<double>(i);
        x.push_back({20.0 + 19.9 * std::cos(turn), 20.0 + 19.9 * std::sin(turn)});
    }
    return x;
}

TEST_CASE("circles at the edge have an answer at every sigma, equal to the other way's")
{
    const layout l(palm);
    const std::vector<point> x = circles(1001);
    const std::vector<double> t = onsets(x.size(), 0.07);
    double before = 0.0;
    for (double sigma = 5.0; sigma <= 200.0; sigma += 5.0) {
        CAPTURE(sigma);
        const double rms = std::sqrt(cost(compensate(l, {sigma, 100.0}, t, x).felt, x) / 1001.0);
        CHECK(rms > before); // a stronger pull leaves less
        before = rms;
    }
    CHECK(before < 19.9); // all in the middle
    for (const double sigma : {20.0, 80.0, 81.0}) {
        CAPTURE(sigma);
        const low_speed_observer o{sigma, 100.0};
        const double ours = cost(compensate(l, o, t, x).felt, x);
        const double theirs = by_gradients(l, o, t, x, 3000);
        CHECK(ours <= theirs * (1.0 + 1e-9));
        CHECK(theirs <= ours * (1.0 + 1e-4));
    }
    CHECK(std::sqrt(cost(compensate(l, {80.0, 100.0}, t, x).felt, x) / 1001.0) ==
          doctest::Approx(18.04).epsilon(3e-4)); // L-BFGS-B, too
}

TEST_CASE("arrays of all kinds have an answer, for any strength of pull")
{
    generator g(29);
    for (int round = 0; round < rounds(96); ++round) {
        CAPTURE(round);
        const layout l(some_array(g, static_cast<unsigned>(round) % kinds_of_array));
        const low_speed_observer o{std::pow(10.0, between(g, 0.0, 3.0)), 100.0};
        CAPTURE(o.sigma_mm);
        std::vector<double> t{0.0};
        std::vector<point> x{some_point(g, l)};
        while (t.size() < 300) {
            t.push_back(t.back() + between(g, 0.01, 0.2));
            x.push_back(some_point(g, l));
        }
        const compensated_places p = compensate(l, o, t, x);
        for (const point& m : p.played)
            REQUIRE(l.contains(m));
        CHECK(cost(p.felt, x) <= by_gradients(l, o, t, x, 100) + 1e-6);
    }
}

TEST_CASE("long chains have an answer; pulls beyond rounding and a million taps are refused")
{
    const layout l(palm);
    CHECK_THROWS_WITH_AS(compensate(l, {1000.0, 0.001}, {{0.0, 0.07}}, {{{0.0, 0.0}, {40.0, 0.0}}}),
                         doctest::Contains("sigma_mm"), error);
    CHECK_THROWS_WITH_AS(compensate(l, {}, {{0.0, 0.0}}, {{{0.0, 0.0}, {40.0, 0.0}}}),
                         doctest::Contains("begin at nearly the same time"), error);
    std::vector<point> x = circles(20'001);
    for (const double sigma : {5.0, 200.0}) {
        CAPTURE(sigma);
        const compensated_places p = compensate(l, {sigma, 100.0}, onsets(x.size(), 0.07), x);
        CHECK(cost(p.felt, x) < cost(std::vector<point>(x.size(), {20.0, 20.0}), x));
        CHECK((sigma > 5.0 || p.at_edge > 1000));
    }
    x.clear(); // to and fro between two corners: no array is wide enough
    for (std::size_t i = 0; i < 1'000'001; ++i)
        x.push_back(i % 2 == 0 ? point{0.0, 0.0} : point{40.0, 40.0});
    CHECK_THROWS_WITH_AS(compensate(l, {}, onsets(x.size(), 0.07), x), doctest::Contains("too many"), error);
}

TEST_CASE("compensation moves a whole plan: places, drives and its description")
{
    const compensated_plan p = of_motion("park2016-1", phantom_kind::barycentric);
    const plan before = make_plan(palm, preset_stroke("park2016-1"), {.phantom = phantom_kind::barycentric});
    REQUIRE(p.plan.bursts.size() == before.bursts.size());
    CHECK(p.observer == low_speed_observer{});
    bool moved = false;
    for (std::size_t i = 0; i < before.bursts.size(); ++i) {
        const burst& b = p.plan.bursts[i];
        CHECK(b.onset_s == before.bursts[i].onset_s);
        CHECK(b.duration_s == before.bursts[i].duration_s);
        CHECK(energy(b.drives) == doctest::Approx(1.0).epsilon(1e-12));
        CHECK(distance_mm(energy_centroid(layout(palm), b.drives), b.position) < 1e-9);
        CHECK(distance_mm(p.taps[i].alone, b.position) < 1e-9);
        moved = moved || distance_mm(b.position, before.bursts[i].position) > 0.1;
    }
    CHECK(moved);
    REQUIRE(p.plan.warnings.size() == before.warnings.size() + 1);
    for (const char* word : {"low-speed", "sigma 5 mm", "taps", "RMS"})
        CHECK(p.plan.warnings.back().find(word) != std::string::npos);
    // With another phantom its own error stays.
    const compensated_plan q = of_motion("park2016-1", phantom_kind::inverse_distance);
    CHECK(q.residual_rms_mm == doctest::Approx(p.residual_rms_mm).epsilon(1e-9));
    CHECK(*summarise(q.taps).rms_error_mm > p.residual_rms_mm + 0.1);
    // The Tactile Brush is moved off its lines, and says so.
    const compensated_plan brushed =
        of_motion("park2016-1", phantom_kind::barycentric, {2.0, 100.0}, algorithm_kind::tactile_brush);
    CHECK(brushed.plan.warnings.back().find("Tactile Brush") != std::string::npos);
    CHECK_THROWS_WITH_AS(of_motion("park2016-1", phantom_kind::log, {}, algorithm_kind::continuous),
                         doctest::Contains("no bursts"), error);
}

TEST_CASE("moved bursts keep the phantom and the scale of their plan")
{
    stroke s = preset_stroke("park2016-3");
    s.motion = trajectory::timed({{0.0, {5.0, 20.0}, 0.5}, {1.0, {35.0, 20.0}, 0.5}});
    s.choices.phantom = phantom_kind::barycentric;
    for (const scale_kind k : all_values<scale_kind>()) {
        const plan_options o{.scale = {.kind = k, .sl_db = 30.0}};
        const compensated_plan p = make_compensated_plan(palm, layout(palm), s, o, {});
        const double asked = std::pow(o.scale.amplitude(0.5), 2.0);
        CHECK(p.plan.phantom == "barycentric");
        for (const burst& b : p.plan.bursts) {
            CHECK(energy(b.drives) == doctest::Approx(asked).epsilon(1e-12));
            CHECK(distance_mm(energy_centroid(layout(palm), b.drives), b.position) < 1e-9);
        }
    }
}

TEST_CASE("misses of the three closest are counted at the moved places")
{
    const array wide = make_grid("wide", 3, 3, 20.0, 40.0);
    const layout l(wide);
    const stroke s{"s", trajectory::along(path::from_svg("M 2 8 L 38 16"), 0.5)};
    const plan_options o{.faces = faces_kind::nearest};
    const auto model = make_phantom(phantom_kind::inverse_distance, l, o.faces);
    const plan still = make_plan(wide, l, s, o);
    const compensated_plan p = make_compensated_plan(wide, l, s, o, {.sigma_mm = 10.0});
    std::vector<drive> d;
    for (const burst& b : p.plan.bursts) {
        model->weights(b.position, b.intensity, d);
        CHECK(b.drives == d);
    }
    const auto missed = [](const plan& of) {
        std::vector<std::string> all;
        std::copy_if(of.warnings.begin(), of.warnings.end(), std::back_inserter(all), [](const auto& w) {
            return w.find("outside the triangle of the three closest") != std::string::npos;
        });
        return all;
    };
    REQUIRE(missed(still).size() == 1);
    REQUIRE(missed(p.plan).size() == 1);
    CHECK(missed(still) != missed(p.plan));
}

TEST_CASE("a fitted stroke is compensated at its fitted place")
{
    stroke s = preset_stroke("park2016-1");
    s.fit = stroke_fit{12.0};
    const compensated_plan p = make_compensated_plan(palm, layout(palm), s, {}, {});
    const stroke fitted = apply_fits({s}, layout(palm)).front();
    for (const tap& t : p.taps)
        CHECK(distance_mm(t.target, fitted.motion.position(t.onset_s)) < 1e-9);
}

} // namespace observer_test
