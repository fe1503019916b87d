// SPDX-License-Identifier: MIT

#include <doctest/doctest.h>

#include "study/statistics/tests.hpp"

namespace tactor::study::test_anova {
namespace {

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

} // namespace
} // namespace tactor::study::test_anova
