// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/percept.hpp>

#include "../plan/arrays.hpp"
#include "../plan/strokes.hpp"

namespace observer_test {

using namespace tactor;
using namespace tactor::test;

namespace {

tap_summary of_motion(phantom_kind phantom, double sigma_mm, point* first = nullptr)
{
    const stroke s = preset_stroke("park2016-1");
    plan_options o;
    o.phantom = phantom;
    const std::vector<tap> taps = predict_taps(palm, s, make_plan(palm, s, o), {sigma_mm, 100.0});
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
    try {
        static_cast<void>(felt_places(o, t, m));
    } catch (const error& e) {
        return e.what();
    }
    return {};
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
    std::vector<double> t(n);
    for (std::size_t i = 0; i < n; ++i)
        t[i] = 0.07 * static_cast<double>(i);
    const std::vector<point> x = felt_places({}, t, m);
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
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    CHECK_THROWS_WITH_AS(predict_taps(palm, s, make_plan(palm, s, o)), doctest::Contains("continuous"),
                         error);
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

} // namespace observer_test
