// SPDX-License-Identifier: MIT
// Tests of means: Student's t and signs, analysis of variance, Tukey's comparisons.
#include "study/statistics/tests.hpp"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

namespace tactor::study::test_statistics {
namespace {

const std::vector<double> sleep{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0}; // Student 1908

// Tries all choices of signs.
double by_counting(const std::vector<double>& v)
{
    double observed = 0.0;
    double all = 0.0;
    for (const double x : v) {
        observed += x;
        all += std::abs(x);
    }
    std::size_t far = 0;
    for (std::size_t signs = 0; signs < (std::size_t{1} << v.size()); ++signs) {
        double sum = 0.0;
        for (std::size_t i = 0; i < v.size(); ++i)
            sum += (signs >> i & 1U) != 0 ? v[i] : -v[i];
        far += std::abs(sum) >= std::abs(observed) - 1e-9 * all ? 1 : 0;
    }
    return static_cast<double>(far) / static_cast<double>(std::size_t{1} << v.size());
}

TEST_CASE("Student's own data give what R's t.test gives")
{
    const t_test t = test_mean(sleep, 0.0);
    CHECK(*t.mean == doctest::Approx(0.75).epsilon(1e-12));
    CHECK(*t.t == doctest::Approx(1.3257101407138212).epsilon(1e-12));
    CHECK(*t.df == 9.0);
    CHECK(*t.p == doctest::Approx(0.2175977800684489).epsilon(1e-11));
    CHECK(t.ci->first == doctest::Approx(-0.5297804135262322).epsilon(1e-11));
    CHECK(t.ci->second == doctest::Approx(2.0297804135262321).epsilon(1e-11));
    CHECK(*t.d == doctest::Approx(*t.t / std::sqrt(10.0)).epsilon(1e-12));
    CHECK(t.d_ci->first < *t.d);
    CHECK(t.d_ci->second > *t.d);
}

TEST_CASE("noncentralities are those of R's pt")
{
    // uniroot() on pt(t, df, ncp), R 4.2.2
    const auto i = noncentrality_interval(6.84, 11.0);
    CHECK(i->first == doctest::Approx(3.35742834652).epsilon(1e-10));
    CHECK(i->second == doctest::Approx(10.22490451530).epsilon(1e-10));
    const auto mirrored = noncentrality_interval(-6.84, 11.0);
    CHECK(mirrored->first == doctest::Approx(-i->second).epsilon(1e-10));
    // R's pt ends beyond 37.6: the greatest value.
    CHECK(noncentrality_interval(9000.0, 11.0)->first == doctest::Approx(5300.7335778).epsilon(1e-8));
    CHECK(!noncentrality_interval(1e5, 11.0));
}

TEST_CASE("equal values have a mean and signs, and no test")
{
    const t_test t = test_mean(std::vector<double>{70.0, 70.0, 70.0, 70.0}, 50.0);
    CHECK(*t.mean == 70.0);
    CHECK(*t.se == 0.0);
    CHECK(!t.ci);
    CHECK(!t.t);
    CHECK(!t.p);
    CHECK(!t.d);
    CHECK(!t.d_ci);
    CHECK(*t.p_signflip == 0.125);
    CHECK(!varies(std::vector<double>{100.0 / 3.0, 33.333333333333336, 100.0 - 200.0 / 3.0}));
    const t_test one = test_mean(std::vector<double>{70.0}, 50.0);
    CHECK(*one.mean == 70.0);
    CHECK(!one.se);
    CHECK(!one.p_signflip);
    CHECK(!test_mean({}, 50.0).mean);
}

TEST_CASE("a rounding of equal values is no variance, and has no sign")
{
    // Differences of ratings from 1 to 5 whose means are equal, added up in another order.
    const std::vector<double> noise{4.4e-16, 2.2e-16, 4.4e-16, 4.4e-16, 2.2e-16, 4.4e-16};
    CHECK(varies(noise));
    CHECK(!varies(noise, 5e-12));
    const t_test none = test_mean(noise, 0.0, 5e-12);
    CHECK(!none.t);
    CHECK(!none.d);
    CHECK(*none.p_signflip == 1.0);
    CHECK(!quick_test_mean(noise, 0.0, 5e-12).p);
    // Equal signs, and equal values except for rounding.
    const t_test one = test_mean(std::vector<double>{0.25, 0.25 + 2.2e-16, 0.25 - 4.4e-16, 0.25}, 0.0, 5e-12);
    CHECK(!one.t);
    CHECK(*one.p_signflip == 0.125);
    // Per cent of halves that were added up from thirds.
    const std::vector<double> halves{50.0 + 7e-15, 50.0 + 7e-15, 50.0 + 1.4e-14, 50.0 + 7e-15};
    CHECK(*test_mean(halves, 50.0).p_signflip == 1.0);
    // Real differences stay: half of a scale's last step in a million trials.
    CHECK(test_mean(std::vector<double>{0.0, 5e-7, 0.0, 5e-7}, 0.0, 5e-12).t);
}

TEST_CASE("signs are exact, with ties and zeros")
{
    for (const std::vector<double>& v :
         {sleep, std::vector<double>{10.0, 20.0, 10.0, -10.0, 0.0, 30.0, 10.0}, std::vector<double>{0.0, 0.0},
          std::vector<double>{100.0 / 3.0, -100.0 / 3.0, 200.0 / 3.0, 0.1, 0.2, 0.3},
          std::vector<double>{5.0}, std::vector<double>{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, -64.0, 128.0}})
        CHECK(*sign_flip_p(v) == by_counting(v));
    CHECK(*sign_flip_p(std::vector<double>(12, 20.0)) == std::pow(2.0, -11.0));
    CHECK(*sign_flip_p(std::vector<double>(400, 2.5)) == doctest::Approx(std::pow(2.0, -399.0)));
    std::vector<double> many;
    for (int i = 0; i < 36; ++i)
        many.push_back(std::sqrt(2.0 + i));
    CHECK(*sign_flip_p(many) == doctest::Approx(std::pow(2.0, -35.0)));
    many.resize(60, std::exp(1.0));
    for (std::size_t i = 36; i < 60; ++i)
        many[i] += std::sin(static_cast<double>(i));
    CHECK(!sign_flip_p(many));
    CHECK(!sign_flip_p({}));
}

TEST_CASE("Holm's p are in order, at most 1, and missing ones do not count")
{
    const auto h = holm({0.01, std::nullopt, 0.04, 0.03, 0.9});
    CHECK(*h[0] == doctest::Approx(0.04));
    CHECK(!h[1]);
    CHECK(*h[2] == doctest::Approx(0.09));
    CHECK(*h[3] == doctest::Approx(0.09));
    CHECK(*h[4] == doctest::Approx(0.9));
    CHECK(*holm({0.8, 0.7})[0] == 1.0);
}

// Six people, 2 x 3 cells.
const cell_table study{{{420, 420, 480, 480, 600, 780},
                        {420, 480, 480, 360, 480, 600},
                        {480, 480, 540, 660, 780, 780},
                        {420, 540, 540, 480, 780, 900},
                        {540, 660, 540, 480, 660, 720},
                        {360, 420, 360, 360, 480, 540}},
                       2,
                       3};

TEST_CASE("with two levels F is the square of the paired t, with its p")
{
    std::vector<double> differences;
    for (const auto& row : study.values)
        differences.push_back((row[3] + row[4] + row[5] - row[0] - row[1] - row[2]) / 3.0);
    const t_test t = test_mean(differences, 0.0);
    const effect e = repeated_measures(study).first;
    CHECK(*e.f == doctest::Approx(*t.t * *t.t).epsilon(1e-12));
    CHECK(*e.p == doctest::Approx(*t.p).epsilon(1e-11));
    CHECK(e.df1 == 1.0);
    CHECK(e.df2 == 5.0);
    CHECK(!e.epsilon_gg);
    CHECK(!e.mauchly_w);
}

TEST_CASE("equal values are no effect, and scale and place do not matter")
{
    const anova a = repeated_measures(study);
    cell_table moved = study;
    for (std::size_t i = 0; i < moved.values.size(); ++i)
        for (double& v : moved.values[i])
            v = 3.0 * v + 17.0 * static_cast<double>(i);
    const anova b = repeated_measures(moved);
    for (const auto& [x, y] :
         {std::pair{a.first, b.first}, {a.second, b.second}, {a.interaction, b.interaction}}) {
        CHECK(*x.f == doctest::Approx(*y.f).epsilon(1e-10));
        CHECK(*x.eta2_partial == doctest::Approx(*y.eta2_partial).epsilon(1e-10));
        if (x.epsilon_gg)
            CHECK(*x.epsilon_gg == doctest::Approx(*y.epsilon_gg).epsilon(1e-10));
        if (x.mauchly_p)
            CHECK(*x.mauchly_p == doctest::Approx(*y.mauchly_p).epsilon(1e-10));
    }
    CHECK(*a.second.eta2_generalised < *a.second.eta2_partial);
}

TEST_CASE("epsilon is 1 where all differences vary alike and 1 / (k - 1) where only one does")
{
    CHECK(greenhouse_geisser({{2.0, 0.0}, {0.0, 2.0}}) == doctest::Approx(1.0));
    CHECK(greenhouse_geisser({{1.0, 1.0}, {1.0, 1.0}}) == doctest::Approx(0.5));
    CHECK(mauchly({{2.0, 0.0}, {0.0, 2.0}}, 5, 3)->w == doctest::Approx(1.0));
    for (const double v : {0.1, 0.3, 0.7, 1.1, 2.3}) { // and never above, for any rounding
        CHECK(greenhouse_geisser({{v, 0.0, 0.0}, {0.0, v, 0.0}, {0.0, 0.0, v}}) <= 1.0);
        CHECK(mauchly({{v, 0.0, 0.0}, {0.0, v, 0.0}, {0.0, 0.0, v}}, 5, 4)->w <= 1.0);
    }
    CHECK(!mauchly({{1.0, 1.0}, {1.0, 1.0}}, 5, 3)); // singular
    CHECK(!mauchly({{2.0, 0.0}, {0.0, 2.0}}, 1, 3)); // two people, three levels
}

TEST_CASE("without an error there is no F, and with one participant nothing")
{
    const cell_table same{{{1, 2, 3}, {2, 3, 4}, {5, 6, 7}}, 1, 3};
    const effect e = repeated_measures(same).second;
    CHECK(*e.ms_error == 0.0);
    CHECK(!e.f);
    CHECK(!e.eta2_partial);
    CHECK(!e.mauchly_w);
    CHECK(!repeated_measures({{{1, 2, 3}}, 1, 3}).second.ms_error);
    CHECK(!repeated_measures({{}, 1, 3}).second.f);
    CHECK(!repeated_measures(study).first.mauchly_p);
    const effect none = repeated_measures({{{1}, {2}}, 1, 1}).second;
    CHECK(!none.f);
}

TEST_CASE("the studentized range matches its definition, integrated by R")
{
    struct known {
        double q;
        std::size_t levels;
        double df;
        double p;
    };
    // integrate() twice over the definition, relative tolerance 1e-9 (R's ptukey is off by 1e-3 with df 2, by
    // 3e-7 with 50 levels).
    for (const known& k : {known{3.5, 4, 33, 0.0827866510280034}, known{40, 10, 2, 0.00629123165036593},
                           known{4, 50, 1000, 0.769333841286478}, known{1, 2, 1, 0.608173447969393},
                           known{200, 4, 1, 0.00821299674580652}})
        CHECK(studentized_range_p(k.q, k.levels, k.df) == doctest::Approx(k.p).epsilon(1e-9));
    // R's ptukey where that is good
    CHECK(std::abs(studentized_range_p(10, 4, 33) - 2.5138566073224e-07) < 1e-11);
    CHECK(std::abs(studentized_range_p(0.1, 3, 5) - 0.997248706663421) < 1e-8);
}

TEST_CASE("with two levels it is Student's t, also where that is small")
{
    for (const double df : {1.0, 2.0, 7.0, 33.0, 500.0, 100000.0})
        for (const double q : {0.001, 0.5, 3.0, 9.0}) {
            const double p = p_of_t(q / std::numbers::sqrt2, df);
            CHECK(std::abs(studentized_range_p(q, 2, df) - p) < 1e-6 * p);
            CHECK(std::abs(studentized_range_p(q, 2, df) - p) < 1e-11);
        }
}

TEST_CASE("it is 1 for no range, never above, and falls")
{
    CHECK(studentized_range_p(0.0, 4, 33) == 1.0);
    double last = 1.0;
    for (double q = 0.0; q < 50.0; q += 0.37) {
        const double p = studentized_range_p(q, 5, 12);
        CHECK(p <= last);
        CHECK(p >= 0.0);
        last = p;
    }
    CHECK(studentized_range_p(1e9, 5, 200) < 1e-20);
    CHECK(studentized_range_p(3.0, 1000, 50) == doctest::Approx(1.0));
}

TEST_CASE("all pairs in order; without an error differences alone")
{
    const auto pairs = tukey({1.0, 3.0, 2.0}, 4, 1.0, 9.0);
    REQUIRE(pairs.size() == 3);
    CHECK(pairs[0].a == 0);
    CHECK(pairs[0].b == 1);
    CHECK(pairs[0].difference == -2.0);
    CHECK(*pairs[0].q == 4.0);
    CHECK(*pairs[1].p == studentized_range_p(2.0, 3, 9.0));
    CHECK(pairs[2].difference == 1.0);
    CHECK(!tukey({1.0, 3.0}, 4, 0.0, 3.0)[0].q);
    CHECK(!tukey({1.0, 3.0}, 1, std::nullopt, 0.0)[0].p);
}

} // namespace
} // namespace tactor::study::test_statistics
