// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <doctest/doctest.h>

#include <tactor/percept.hpp>

#include "../plan/arrays.hpp"
#include "../plan/strokes.hpp"

namespace percept_test {

using namespace tactor;
using namespace tactor::test;

namespace {

std::vector<percept_sample> predict(const array& a, const stroke& s, const plan_options& o = {})
{
    return predict_percept(a, s, make_plan(a, s, o));
}

plan make_test_plan(std::vector<burst> bursts, overlap_kind join = overlap_kind::energy)
{
    return {.overlap = join, .bursts = std::move(bursts)};
}

burst one_burst(double onset_s, double duration_s, std::vector<drive> drives)
{
    return {.onset_s = onset_s, .duration_s = duration_s, .drives = std::move(drives)};
}

const array pair = make_array({{0.0, 0.0}, {10.0, 0.0}});

/// Computes the prediction without the speed, from scratch at each time.
percept_sample by_search(const array& a, const plan& p, double t_s)
{
    percept_sample r;
    std::map<unsigned, std::vector<std::pair<double, double>>> parts; // amplitude, intensity
    const auto add = [&](const burst& b) {
        for (const drive& d : b.drives)
            parts[d.tactor].push_back({d.amplitude, b.intensity});
    };
    if (p.curve) {
        burst b;
        p.curve->at(t_s, b);
        add(b);
    }
    for (const burst& b : p.bursts)
        if (b.onset_s <= t_s + 1e-9 && t_s < b.onset_s + b.duration_s - 1e-9)
            add(b);
    point c;
    double energy = 0.0;
    for (const auto& [tactor, list] : parts) {
        r.shared = r.shared || list.size() > 1;
        double e = 0.0;
        double cap = 0.0;
        for (const auto& [amplitude, intensity] : list) {
            e += amplitude * amplitude;
            cap = std::max(cap, intensity);
        }
        e = std::min(e, cap * cap);
        energy += e;
        c.x_mm += e * a.tactors[tactor].position.x_mm;
        c.y_mm += e * a.tactors[tactor].position.y_mm;
    }
    r.intensity = std::sqrt(energy);
    if (energy > 0.0)
        r.felt = point{c.x_mm / energy, c.y_mm / energy};
    return r;
}

} // namespace

TEST_CASE("by hand: a line between two tactors in two bursts")
{
    // 10 mm in 0.1 s: bursts at 0 s where the target is at 0 mm, and at 0.07 s where it is at 7 mm. The
    // centroid of Eq. (2) is the point itself, so the error is the target's distance since the onset: 0.1 i
    // mm for i = 0 ... 69, then for i = 0 ... 30.
    const stroke s = along("M 0 0 L 10 0", 0.1);
    const plan p = make_plan(pair, s);
    REQUIRE(p.bursts.size() == 2);
    const auto samples = predict_percept(pair, s, p);
    REQUIRE(samples.size() == 101);
    CHECK(samples[0].felt->x_mm == 0.0);
    CHECK(samples[69].felt->x_mm == 0.0);
    CHECK(samples[70].felt->x_mm == doctest::Approx(7.0).epsilon(1e-12));
    CHECK(samples[100].felt->x_mm == doctest::Approx(7.0).epsilon(1e-12));
    CHECK(samples[100].target.x_mm == doctest::Approx(10.0).epsilon(1e-12));
    const percept_summary r = summarise(samples);
    const double squares = 69.0 * 70.0 * 139.0 / 6.0 + 30.0 * 31.0 * 61.0 / 6.0;
    CHECK(*r.rms_error_mm == doctest::Approx(0.1 * std::sqrt(squares / 101.0)).epsilon(1e-12));
    CHECK(*r.largest_error_mm == doctest::Approx(6.9).epsilon(1e-12));
    CHECK(*r.intensity_cv < 1e-12);
    CHECK(r.silent_share == 0.0);
    CHECK(r.shared_share == 0.0);
    CHECK_FALSE(r.speed_cv); // shorter than the window
}

TEST_CASE("by hand: the speed of one jump is the average's ramp")
{
    // A tactor for half a second, then another 10 mm away: the average over 101 samples rises by 10/101 mm
    // each millisecond, from sample 449 on to sample 550, at whose ends the central difference is half that.
    const stroke s = along("M 0 0 L 10 0", 1.0);
    const auto samples = predict_percept(
        pair, s, make_test_plan({one_burst(0.0, 0.5, {{0, 1.0}}), one_burst(0.5, 0.5, {{1, 1.0}})}));
    REQUIRE(samples.size() == 1001);
    const double ramp = 10.0 / 101.0 / 0.001;
    for (std::size_t i = 0; i <= 1000; ++i) {
        CAPTURE(i);
        REQUIRE(samples[i].speed_mm_s.has_value() == (i >= 51 && i <= 949));
        if (!samples[i].speed_mm_s)
            continue;
        const double expected = i < 449 || i > 550 ? 0.0 : i == 449 || i == 550 ? ramp / 2.0 : ramp;
        REQUIRE(*samples[i].speed_mm_s == doctest::Approx(expected).epsilon(1e-9));
    }
    CHECK(*summarise(samples).speed_cv ==
          doctest::Approx(std::sqrt(899.0 * 100.5 / (101.0 * 101.0) - 1.0)).epsilon(1e-9));
}

TEST_CASE("continuous with barycentric weights is felt where the target is")
{
    const plan_options o{.algorithm = algorithm_kind::continuous, .phantom = phantom_kind::barycentric};
    const percept_summary r = summarise(predict(palm, preset_stroke("park2016-4"), o));
    CHECK(*r.largest_error_mm < 1e-9);
    CHECK(*r.speed_cv < 1e-3); // the average of an arc lies inside it, always as far
    CHECK(*r.intensity_cv < 1e-9);
    CHECK(r.silent_share == 0.0);
}

TEST_CASE("overlapping bursts on one tactor are joined by the plan's rule")
{
    const stroke s = along("M 0 0 L 10 0", 0.1);
    const std::vector<burst> both{one_burst(0.0, 0.1, {{0, 0.8}}),
                                  one_burst(0.04, 0.04, {{0, 0.8}, {1, 0.6}})};
    const double on_one[] = {1.0, 0.8, 1.6}; // sqrt(1.28) is over the given intensity
    for (const overlap_kind join : {overlap_kind::energy, overlap_kind::max, overlap_kind::sum}) {
        const auto samples = predict_percept(pair, s, make_test_plan(both, join));
        const double a = on_one[static_cast<int>(join)];
        CHECK_FALSE(samples[39].shared);
        CHECK(samples[39].intensity == doctest::Approx(0.8));
        CHECK(samples[40].shared);
        CHECK(samples[40].intensity == doctest::Approx(std::sqrt(a * a + 0.36)));
        CHECK(samples[40].felt->x_mm == doctest::Approx(3.6 / (a * a + 0.36)));
        CHECK(samples[79].shared);
        CHECK_FALSE(samples[80].shared);
        CHECK(summarise(samples).shared_share == doctest::Approx(40.0 / 101.0));
    }
}

TEST_CASE("silence is intensity 0, has no error, and holds the position for the speed")
{
    const stroke s = along("M 0 0 L 10 0", 0.2);
    const auto samples = predict_percept(
        pair, s, make_test_plan({one_burst(0.02, 0.05, {{0, 1.0}}), one_burst(0.1, 0.05, {{1, 1.0}})}));
    REQUIRE(samples.size() == 201);
    CHECK_FALSE(samples[19].felt);
    CHECK(samples[20].felt);
    CHECK(samples[69].felt);
    CHECK_FALSE(samples[70].felt);
    CHECK_FALSE(samples[200].felt);
    const percept_summary r = summarise(samples);
    CHECK(r.silent_share == doctest::Approx(101.0 / 201.0));
    const double share = 100.0 / 201.0;
    CHECK(*r.intensity_cv == doctest::Approx(std::sqrt(share * (1.0 - share)) / share));
    CHECK(*r.largest_error_mm == doctest::Approx(5.0)); // at 0.1 s
    CHECK_FALSE(samples[70].speed_mm_s);                // the window reaches back to before 0.02 s
    CHECK(*samples[71].speed_mm_s == doctest::Approx(10.0 / 101.0 / 0.001));
}

TEST_CASE("a burst that ends with the movement is felt at its last sample, unless another begins there")
{
    const stroke s = along("M 0 0 L 10 0", 0.1);
    const auto alone = predict_percept(pair, s, make_test_plan({one_burst(0.0, 0.1, {{0, 1.0}})}));
    CHECK(alone.back().felt);
    CHECK(summarise(alone).silent_share == 0.0);
    const auto next = predict_percept(
        pair, s, make_test_plan({one_burst(0.0, 0.1, {{0, 1.0}}), one_burst(0.1, 0.1, {{1, 1.0}})}));
    CHECK(next[99].felt->x_mm == 0.0);
    CHECK(next.back().felt->x_mm == 10.0);
    CHECK_FALSE(next.back().shared);
    const auto longer = predict_percept(
        pair, s, make_test_plan({one_burst(0.0, 0.12, {{0, 1.0}}), one_burst(0.05, 0.05, {{1, 1.0}})}));
    CHECK(longer.back().felt->x_mm == doctest::Approx(5.0));
    const auto early = predict_percept(pair, s, make_test_plan({one_burst(0.0, 0.0999, {{0, 1.0}})}));
    CHECK_FALSE(early.back().felt);
}

TEST_CASE("the last sample is on the raster, at the end where the end is")
{
    CHECK(predict(pair, along("M 0 0 L 10 0", 0.0005)).size() == 1);
    CHECK(predict(pair, along("M 0 0 L 10 0", 0.0019)).size() == 2);
    CHECK(predict(pair, along("M 0 0 L 10 0", 0.002)).size() == 3);
    CHECK(predict(pair, along("M 0 0 L 10 0", 0.002 - 0.5e-9)).size() == 3);
    CHECK(predict(pair, along("M 0 0 L 10 0", 0.002 - 2e-9)).size() == 2);
    for (const double t : {0.7, 1.1, 1.4, 2.1, 3.3, 7.7, 1234.567})
        CHECK(predict(pair, along("M 0 0 L 10 0", t)).size() ==
              static_cast<std::size_t>(std::lround(t * 1e3)) + 1);
}

TEST_CASE("any plan is felt like in a search at each time")
{
    generator g(31);
    unsigned compared = 0;
    for (unsigned round = 0; round < 150; ++round) {
        const array a =
            make_grid("grid", pick(g, 2, 4), pick(g, 2, 4), between(g, 5.0, 30.0), between(g, 5.0, 30.0));
        const point corner = a.tactors.back().position;
        std::vector<timed_point> points{{0.0, {0.0, 0.0}, 1.0}};
        for (unsigned i = 1; i <= 4; ++i)
            points.push_back({i * between(g, 0.2, 0.25),
                              {between(g, 0, corner.x_mm), between(g, 0, corner.y_mm)},
                              between(g, 0.0, 1.0)});
        const stroke s = timed(points);
        plan_options o{
            .algorithm = static_cast<algorithm_kind>(round % 3), .snap = true, .drop_points = true};
        o.phantom = static_cast<phantom_kind>(pick(g, 0, 4));
        o.soa_s = between(g, 0.048, 0.07);
        const plan p = make_plan(a, s, o);
        for (const percept_sample& x : predict_percept(a, s, p)) {
            const percept_sample y = by_search(a, p, x.t_s);
            if (x.t_s > p.stroke_duration_s - 1e-9)
                continue;
            ++compared;
            REQUIRE(x.shared == y.shared);
            REQUIRE(x.intensity == doctest::Approx(y.intensity).epsilon(1e-12));
            REQUIRE(x.felt.has_value() == y.felt.has_value());
            REQUIRE((!x.felt || distance_mm(*x.felt, *y.felt) < 1e-9));
            REQUIRE(distance_mm(x.target, s.motion.position(x.t_s)) == 0.0);
            REQUIRE(x.target_intensity == s.motion.intensity(x.t_s));
        }
    }
    CHECK(compared > 100000);
}

TEST_CASE("the summary of a plan is that of its samples, to the last bit")
{
    const auto same = [](const percept_summary& x, const percept_summary& y) {
        return x.rms_error_mm == y.rms_error_mm && x.largest_error_mm == y.largest_error_mm &&
               x.lag_s == y.lag_s && x.rms_at_lag_mm == y.rms_at_lag_mm && x.along_rms_mm == y.along_rms_mm &&
               x.along_max_mm == y.along_max_mm && x.across_rms_mm == y.across_rms_mm &&
               x.across_max_mm == y.across_max_mm && x.rms_to_path_mm == y.rms_to_path_mm &&
               x.speed_cv == y.speed_cv && x.intensity_cv == y.intensity_cv &&
               x.silent_share == y.silent_share && x.shared_share == y.shared_share;
    };
    const array a = preset_array("palm-3x3");
    for (const double duration_s : {0.01, 0.1, 0.102, 0.103, 0.104, 0.2, 1.2, 7.0005}) {
        CAPTURE(duration_s);
        const stroke s = along("M 3 3 C 20 45 20 -5 37 37 L 3 37", duration_s);
        std::vector<plan> plans;
        for (const algorithm_kind algorithm : {algorithm_kind::park2016, algorithm_kind::continuous})
            plans.push_back(make_plan(a, s, {.algorithm = algorithm}));
        // Silent at first, for a while between and at last.
        plans.push_back(make_test_plan({one_burst(0.11 * duration_s, 0.2 * duration_s, {{0, 1.0}, {1, 0.5}}),
                                        one_burst(0.2 * duration_s, 0.2 * duration_s, {{0, 0.3}, {4, 0.5}}),
                                        one_burst(0.6 * duration_s, 0.3 * duration_s, {{8, 1.0}})}));
        plans.push_back(plan{});
        for (std::size_t i = 0; i < plans.size(); ++i) {
            CAPTURE(i);
            CHECK(same(summarise(a, s, plans[i]), summarise(predict_percept(a, s, plans[i]))));
        }
    }
}

TEST_CASE("samples come in order, and their receiver may end it")
{
    const stroke s = along("M 0 0 L 10 0", 1.0);
    const plan p = make_plan(pair, s);
    const auto all = predict_percept(pair, s, p);
    REQUIRE(all.size() == 1001);
    std::size_t n = 0;
    follow_percept(pair, s, p, {}, [&](const percept_sample& x) {
        REQUIRE(x.t_s == doctest::Approx(0.001 * static_cast<double>(n)));
        REQUIRE(x.felt == all[n].felt);
        REQUIRE(x.speed_mm_s == all[n].speed_mm_s);
        ++n;
    });
    CHECK(n == all.size());
    n = 0;
    CHECK_THROWS_AS(follow_percept(pair, s, p, {},
                                   [&](const percept_sample&) {
                                       if (++n == 10)
                                           throw std::runtime_error("enough");
                                   }),
                    std::runtime_error);
    CHECK(n == 10);
}

TEST_CASE("a silent plan has no error, and an empty summary is no error")
{
    const auto silent = predict(pair, timed({{0.0, {0, 0}, 0.0}, {0.5, {10, 0}, 0.0}}));
    const percept_summary r = summarise(silent);
    CHECK_FALSE(r.rms_error_mm);
    CHECK_FALSE(r.largest_error_mm);
    CHECK_FALSE(r.speed_cv);
    CHECK_FALSE(r.intensity_cv);
    CHECK(r.silent_share == 1.0);
    CHECK_FALSE(summarise(std::vector<percept_sample>{}).rms_error_mm);
    CHECK(summarise(std::vector<percept_sample>{}).silent_share == 0.0);

    // Felt, but without motion.
    const stroke still = along("M 0 0 L 10 0", 0.5);
    const percept_summary q =
        summarise(predict_percept(pair, still, make_test_plan({one_burst(0.0, 0.5, {{0, 1.0}})})));
    CHECK_FALSE(q.speed_cv);
    CHECK(*q.intensity_cv == 0.0);
}

TEST_CASE("plans of hours, and of another array, are refused")
{
    const stroke longest = along("M 0 0 L 10 0", 3600.001);
    CHECK_THROWS_AS(predict_percept(pair, longest, plan{}), error);
    CHECK_THROWS_AS(summarise(pair, longest, plan{}), error);
    const stroke s = along("M 0 0 L 40 40", 1.0);
    for (const algorithm_kind method : {algorithm_kind::park2016, algorithm_kind::continuous})
        CHECK_THROWS_AS(predict_percept(pair, s, make_plan(palm, s, {.algorithm = method})), error);
}

TEST_CASE("by hand: another person feels one tactor less, and another one elsewhere")
{
    // Two equal tactors: half way. One of them 6.0206 dB less: a quarter of the energy, so a fifth of the
    // way.
    const stroke s = along("M 0 0 L 10 0", 0.1);
    const plan p = make_test_plan({one_burst(0.0, 0.1, {{0, 1.0}, {1, 1.0}})});
    const person less{{0.0, 20.0 * std::log10(0.5)}, {}};
    const person moved{{}, {{0.0, 2.0}, {2.0, 2.0}}};
    CHECK(predict_percept(pair, s, p)[50].felt->x_mm == doctest::Approx(5.0).epsilon(1e-12));
    const auto quieter = predict_percept(pair, s, p, less);
    CHECK(quieter[50].felt->x_mm == doctest::Approx(2.0).epsilon(1e-12));
    CHECK(quieter[50].intensity == doctest::Approx(std::sqrt(1.25)).epsilon(1e-12));
    const auto elsewhere = predict_percept(pair, s, p, moved);
    CHECK(elsewhere[50].felt->x_mm == doctest::Approx(6.0).epsilon(1e-12));
    CHECK(elsewhere[50].felt->y_mm == doctest::Approx(2.0).epsilon(1e-12));
    const auto same = predict_percept(pair, s, p, {{0.0, 0.0}, {{}, {}}});
    for (std::size_t i = 0; i < same.size(); ++i)
        CHECK(same[i].felt == predict_percept(pair, s, p)[i].felt);
}

TEST_CASE("a person has a finite number for each tactor")
{
    const stroke s = along("M 0 0 L 10 0", 0.1);
    const plan p = make_plan(pair, s);
    for (const person& who :
         {person{{1.0}, {}}, person{{1.0, 2.0, 3.0}, {}}, person{{}, {{1.0, 1.0}}},
          person{{not_a_number, 0.0}, {}}, person{{infinite, 0.0}, {}}, person{{}, {{infinite, 0.0}, {}}}})
        CHECK_THROWS_AS(predict_percept(pair, s, p, who), error);
}

} // namespace percept_test
