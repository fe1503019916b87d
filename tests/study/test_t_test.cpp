// SPDX-License-Identifier: MIT
#include "study/statistics/tests.hpp"

#include <cmath>

#include <doctest/doctest.h>

namespace tactor::study::test_t_test {
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

} // namespace
} // namespace tactor::study::test_t_test
