// SPDX-License-Identifier: MIT
// Statistics where R has no figure, and the analysis of a study; test_analyze.py compares with R.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "study/analysis/analysis.hpp"
#include "study/results/result.hpp"
#include "study/statistics/bradley_terry.hpp"
#include "study/statistics/pairs.hpp"
#include "study/statistics/scaling.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

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
    CHECK(!test_mean_quickly(noise, 0.0, 5e-12).p);
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

TEST_CASE("epsilon is 1 where all differences vary alike and 1 / (k - 1) where only one does")
{
    CHECK(greenhouse_geisser_epsilon({{2.0, 0.0}, {0.0, 2.0}}) == doctest::Approx(1.0));
    CHECK(greenhouse_geisser_epsilon({{1.0, 1.0}, {1.0, 1.0}}) == doctest::Approx(0.5));
    CHECK(test_sphericity({{2.0, 0.0}, {0.0, 2.0}}, 5, 3)->w == doctest::Approx(1.0));
    for (const double v : {0.1, 0.3, 0.7, 1.1, 2.3}) { // and never above, for any rounding
        CHECK(greenhouse_geisser_epsilon({{v, 0.0, 0.0}, {0.0, v, 0.0}, {0.0, 0.0, v}}) <= 1.0);
        CHECK(test_sphericity({{v, 0.0, 0.0}, {0.0, v, 0.0}, {0.0, 0.0, v}}, 5, 4)->w <= 1.0);
    }
    CHECK(!test_sphericity({{1.0, 1.0}, {1.0, 1.0}}, 5, 3)); // singular
    CHECK(!test_sphericity({{2.0, 0.0}, {0.0, 2.0}}, 1, 3)); // two people, three levels
}

// Reaction times of ten people, ms, as Maxwell and Delaney print them: at 0, 4 and 8 degrees without noise,
// then with noise.
const std::vector<std::vector<double>> reactions{
    {420, 420, 480, 480, 600, 780}, {420, 480, 480, 360, 480, 600}, {480, 480, 540, 660, 780, 780},
    {420, 540, 540, 480, 780, 900}, {540, 660, 540, 480, 660, 720}, {360, 420, 360, 360, 480, 540},
    {480, 480, 600, 540, 720, 840}, {480, 600, 660, 540, 720, 900}, {540, 600, 540, 480, 720, 780},
    {480, 420, 540, 540, 660, 780}};

TEST_CASE("epsilons of Greenhouse and Geisser and of Huynh and Feldt are those of R")
{
    struct known {
        effect e;
        double f;
        double gg;
        double p_gg;
        double hf;
        double p_hf;
    };
    const anova both = analyse_repeated_measures({reactions, 2, 3});
    // anova(mlm, test = "Spherical") and sphericity(), R 4.2.2
    for (const known& k :
         {known{analyse_repeated_measures({reactions, 1, 6}).second, 38.02793296, 0.485491764776,
                2.531991886e-8, 0.67780749156, 7.393013564e-11},
          known{both.second, 40.71910112, 0.961636518148, 3.401704843e-7, 1.2175636033, 2.0867632e-7},
          known{both.interaction, 45.31034483, 0.903977069153, 3.453930861e-7, 1.11786977532,
                9.424092558e-8}}) {
        CHECK(*k.e.f == doctest::Approx(k.f).epsilon(1e-9));
        CHECK(*k.e.epsilon_gg == doctest::Approx(k.gg).epsilon(1e-9));
        CHECK(*k.e.p_gg / k.p_gg == doctest::Approx(1.0).epsilon(1e-8));
        CHECK(*k.e.epsilon_hf == doctest::Approx(k.hf).epsilon(1e-9));
        CHECK(*k.e.p_hf / k.p_hf == doctest::Approx(1.0).epsilon(1e-8));
    }
    CHECK(*both.second.p_hf == *both.second.p); // of an epsilon above 1
    CHECK(!both.first.epsilon_hf);              // two levels
    CHECK(!huynh_feldt_epsilon(0.5, 2.0, 1.0)); // two people
}

TEST_CASE("groups of people are those of R, also of unequal sizes")
{
    // R 4.2.2, car: Anova(lm(values ~ group), type = 3) with contr.sum
    const cell_table row{reactions, 1, 6};
    struct expected {
        const effect& e;
        double df1;
        double df2;
        double f;
        double p;
    };
    const auto hold = [](const expected& x) {
        CHECK(x.e.df1 == x.df1);
        CHECK(x.e.df2 == x.df2);
        CHECK(*x.e.f == doctest::Approx(x.f).epsilon(1e-9));
        CHECK(*x.e.p / x.p == doctest::Approx(1.0).epsilon(1e-8));
    };
    const mixed_anova equal = analyse_groups(row, {0, 1, 0, 1, 0, 1, 0, 1, 0, 1});
    hold({equal.group, 1, 8, 1.1781338360, 3.093579514e-01});
    hold({equal.within.second, 5, 40, 34.9614791988, 1.381609258e-13});
    hold({equal.by_group.second, 5, 40, 0.2742681048, 9.245245497e-01});
    CHECK(*equal.within.second.epsilon_gg == doctest::Approx(0.4690617118).epsilon(1e-9));
    CHECK(*equal.within.second.epsilon_hf == doctest::Approx(0.6758203247).epsilon(1e-9));
    CHECK(*equal.by_group.second.p_gg == doctest::Approx(7.960833824e-01).epsilon(1e-8));
    CHECK(*equal.by_group.second.p_hf == doctest::Approx(8.645649356e-01).epsilon(1e-8));
    CHECK(*equal.group.eta2_partial == doctest::Approx(37500.0 / (37500.0 + 254640.0)));
    CHECK(*equal.by_group.second.eta2_generalised ==
          doctest::Approx(5340.0 / (5340.0 + 254640.0 + 155760.0)));

    const std::vector<std::size_t> three{0, 0, 0, 0, 1, 1, 1, 2, 2, 2};
    const mixed_anova unequal = analyse_groups(row, three);
    hold({unequal.group, 2, 7, 0.6421511039, 5.545585088e-01});
    hold({unequal.within.second, 5, 35, 31.8745069578, 4.307495449e-12});
    hold({unequal.by_group.second, 10, 35, 0.4142658799, 9.303360841e-01});
    CHECK(*unequal.by_group.second.epsilon_hf == doctest::Approx(0.8341145604).epsilon(1e-9));
    CHECK(*unequal.by_group.second.p_gg == doctest::Approx(8.365007771e-01).epsilon(1e-8));
    CHECK(*unequal.by_group.second.mauchly_p == doctest::Approx(0.3125051581).epsilon(1e-8));

    const mixed_anova two = analyse_groups({reactions, 2, 3}, three);
    hold({two.within.first, 1, 7, 28.7943573668, 1.045964745e-03});
    hold({two.by_group.first, 2, 7, 0.5841379310, 5.826218292e-01});
    hold({two.within.interaction, 2, 14, 36.2727272727, 2.898587448e-06});
    hold({two.by_group.second, 4, 14, 0.3207836457, 8.593664950e-01});
    CHECK(*two.by_group.interaction.p_gg == doctest::Approx(9.552355906e-01).epsilon(1e-8));
}

TEST_CASE("pairs of groups agree with the analysis of variance, and with R's pairwise.t.test()")
{
    const auto split = [](const std::vector<std::size_t>& groups) {
        std::vector<std::vector<double>> values(*std::ranges::max_element(groups) + 1);
        for (std::size_t i = 0; i < groups.size(); ++i)
            values[groups[i]].push_back(mean(reactions[i]));
        return values;
    };
    // Two groups: F is the square of t.
    const auto two = compare_group_pairs(split({0, 1, 0, 1, 0, 1, 0, 1, 0, 1}));
    REQUIRE(two.size() == 1);
    CHECK(*two[0].test.t * *two[0].test.t == doctest::Approx(1.1781338360).epsilon(1e-9));
    CHECK(*two[0].test.p == doctest::Approx(3.093579514e-01).epsilon(1e-8));
    CHECK(*two[0].p_holm == *two[0].test.p);
    // More: the squares of all differences, weighted by the groups' sizes, give F.
    const std::vector<double> sizes{4, 3, 3};
    const auto three = compare_group_pairs(split({0, 0, 0, 0, 1, 1, 1, 2, 2, 2}));
    REQUIRE(three.size() == 3);
    double f = 0.0;
    for (const paired_comparison& c : three) {
        f += sizes[c.a] * sizes[c.b] * *c.test.d * *c.test.d / 10.0 / 2.0;
        CHECK(*c.test.df == 7);
        CHECK((c.test.ci->first + c.test.ci->second) / 2.0 == doctest::Approx(*c.test.mean));
        CHECK((c.test.ci->second - c.test.ci->first) / 2.0 == doctest::Approx(2.364624252 * *c.test.se));
    }
    CHECK(f == doctest::Approx(0.6421511039).epsilon(1e-9));
    CHECK(*three[0].p_holm <= 3.0 * *three[0].test.p);

    CHECK(compare_group_pairs({{1.0, 2.0}, {}}).empty());
    for (const auto& groups : {std::vector<std::vector<double>>{{1.0}, {2.0}}, {{1.0, 1.0}, {2.0, 2.0}}}) {
        const auto none = compare_group_pairs(groups);
        REQUIRE(none.size() == 1);
        CHECK(*none[0].test.mean == -1.0);
        CHECK_FALSE(none[0].test.t);
        CHECK_FALSE(none[0].p_holm);
    }
}

TEST_CASE("intervals within participants are those of Cousineau with the correction of Morey")
{
    // Loftus and Masson 1994, table 2; R 4.2.2: qt(0.975, 9) sd / sqrt(10) sqrt(3 / 2) of the values less
    // each person's mean
    const std::vector<std::vector<double>> recalled{{10, 13, 13}, {6, 8, 8},    {11, 14, 14}, {22, 23, 25},
                                                    {16, 18, 20}, {15, 17, 17}, {1, 1, 4},    {12, 15, 17},
                                                    {9, 12, 12},  {8, 9, 12}};
    const std::vector<double> means{11.0, 13.0, 14.2};
    const std::vector<double> halves{0.43097684, 0.64279004, 0.58732243};
    const auto all = within_participant_intervals(recalled);
    CHECK(all.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK((all[i]->first + all[i]->second) / 2.0 == doctest::Approx(means[i]));
        CHECK((all[i]->second - all[i]->first) / 2.0 == doctest::Approx(halves[i]).epsilon(1e-8));
    }
    CHECK(within_participant_intervals({}).empty());
    CHECK(!within_participant_intervals({{1.0, 2.0}})[0]);   // one person
    CHECK(!within_participant_intervals({{1.0}, {2.0}})[0]); // one condition
    CHECK(
        !within_participant_intervals({{1.1, 2.1}, {3.3, 4.3}}, 1e-9)[1]); // people alike in all differences
}

TEST_CASE("without an error there is no F, and with one participant nothing")
{
    const cell_table same{{{1, 2, 3}, {2, 3, 4}, {5, 6, 7}}, 1, 3};
    const effect e = analyse_repeated_measures(same).second;
    CHECK(*e.ms_error == 0.0);
    CHECK(!e.f);
    CHECK(!e.eta2_partial);
    CHECK(!e.mauchly_w);
    CHECK(!analyse_repeated_measures({{{1, 2, 3}}, 1, 3}).second.ms_error);
    CHECK(!analyse_repeated_measures({{}, 1, 3}).second.f);
    const effect none = analyse_repeated_measures({{{1}, {2}}, 1, 1}).second;
    CHECK(!none.f);
}

TEST_CASE("pairs of levels are compared by paired t tests, adjusted for their number")
{
    // Student's sleep data, whose first drug is 0.7 ... 2.0: t.test(), R
    const std::vector<double> second{1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
    const auto all = compare_pairs({sleep, second, sleep}, 1e-10);
    CHECK(all.size() == 3);
    CHECK(all[0].a == 0);
    CHECK(all[0].b == 1);
    CHECK(*all[0].test.mean == doctest::Approx(-1.58));
    CHECK(*all[0].test.t == doctest::Approx(-4.0621277).epsilon(1e-7));
    CHECK(*all[0].test.p == doctest::Approx(0.00283289019738).epsilon(1e-12));
    CHECK(*all[0].p_holm == doctest::Approx(2.0 * 0.00283289019738).epsilon(1e-12)); // of two that have a t
    CHECK(!all[1].test.t);                                                           // equal levels
    CHECK(!all[1].p_holm);
    CHECK(*all[2].test.t == doctest::Approx(4.0621277).epsilon(1e-7));
    CHECK(compare_pairs({{}, {}}, 0.0).empty());
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
            const double p = t_p_value(q / std::numbers::sqrt2, df);
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

TEST_CASE("the interval of a share is that of Clopper and Pearson")
{
    CHECK(binomial_interval(0, 10).first == 0.0);
    CHECK(binomial_interval(0, 10).second == doctest::Approx(0.3084971).epsilon(1e-6));
    CHECK(binomial_interval(8, 10).first == doctest::Approx(0.4439045).epsilon(1e-6));
    CHECK(binomial_interval(8, 10).second == doctest::Approx(0.9747893).epsilon(1e-6));
    CHECK(binomial_interval(10, 10).first == doctest::Approx(0.6915029).epsilon(1e-6));
    CHECK(binomial_interval(10, 10).second == 1.0);
}

TEST_CASE("worths are those of R's glm")
{
    struct known {
        double log_worth;
        double se;
    };
    const auto check = [](const std::vector<std::vector<double>>& wins, const std::vector<known>& all) {
        const std::vector<worth> found = fit_bradley_terry(wins);
        REQUIRE(found.size() == all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            CHECK(std::abs(*found[i].log_worth - all[i].log_worth) < 1e-6);
            CHECK(std::abs(*found[i].se - all[i].se) < 1e-6);
        }
    };
    // Citations among four journals (Stigler 1994); the diagonal is not used.
    check({{714, 730, 498, 221}, {33, 425, 68, 17}, {320, 813, 1072, 142}, {284, 276, 325, 188}},
          {{0.0, 0.0}, {-2.94907250, 0.10254534}, {-0.47956977, 0.06058873}, {0.26895406, 0.07082997}});
    // Baseball at home and away (Agresti 2002, p. 438).
    check({{0, 1, 7, 4, 2, 3, 1},
           {12, 0, 7, 2, 6, 7, 6},
           {6, 6, 0, 4, 4, 6, 5},
           {9, 11, 9, 0, 6, 5, 7},
           {11, 7, 9, 7, 0, 7, 9},
           {10, 6, 7, 8, 6, 0, 6},
           {12, 7, 8, 6, 4, 7, 0}},
          {{0.0, 0.0},
           {1.10769771, 0.33387821},
           {0.68385277, 0.33187667},
           {1.43640843, 0.33956851},
           {1.58135588, 0.34325598},
           {1.24761785, 0.33586092},
           {1.29448512, 0.33666940}});
    // Newton's own steps lead away from the maximum.
    check({{0, 1, 0}, {1, 0, 100001}, {1, 5, 0}},
          {{0.0, 0.0}, {5.21079821, 6.81759660}, {-4.51217877, 6.81763007}});
}

TEST_CASE("a worth without preferences both ways is missing, and does not move the others")
{
    const auto known = [](const std::vector<std::vector<double>>& wins) {
        std::string text;
        for (const worth& w : fit_bradley_terry(wins))
            text += !w.log_worth && !w.se ? '-' : std::isfinite(*w.log_worth) && *w.se < 10.0 ? '+' : '?';
        return text;
    };
    CHECK(known({{0, 0, 3}, {5, 0, 4}, {2, 0, 0}}) == "+-+");                         // wins all
    CHECK(known({{0, 5, 3}, {0, 0, 0}, {2, 4, 0}}) == "+-+");                         // loses all
    CHECK(known({{0, 0, 0}, {5, 0, 4}, {5, 1, 0}}) == "+--");                         // so does the first
    CHECK(known({{0, 3, 0, 0}, {2, 0, 0, 0}, {0, 0, 0, 5}, {0, 0, 1, 0}}) == "++--"); // never compared
    CHECK(known({{0, 5, 0}, {0, 0, 5}, {5, 0, 0}}) == "+++");                         // a circle
    CHECK(known({{0}}) == "+");
    const std::vector<worth> pair = fit_bradley_terry({{0, 3}, {6, 0}});
    const std::vector<worth> more = fit_bradley_terry({{0, 3, 9}, {6, 0, 9}, {0, 0, 0}});
    CHECK(*pair[1].log_worth == doctest::Approx(std::log(2.0)));
    CHECK(*pair[1].se == doctest::Approx(std::sqrt(1.0 / 2.0)));
    CHECK(*more[1].log_worth == doctest::Approx(*pair[1].log_worth));
}

bool warns(const analysis& a, const std::string& text)
{
    const auto has = [&text](const std::vector<std::string>& all) {
        return std::find(all.begin(), all.end(), text) != all.end();
    };
    return has(a.warnings) || has(a.no_figures);
}

run_outline run(const std::string& name, const task* task, unsigned trials)
{
    run_outline r;
    r.name = name;
    r.task = task;
    r.motions = {"m"};
    r.methods = {"a", "b"};
    r.trials = trials;
    return r;
}

// Makes trials of one motion, in which the second method was chosen.
run_data chosen(unsigned trials)
{
    run_data d;
    for (unsigned i = 1; i <= trials; ++i)
        d.trials.push_back({.place = i, .method_1 = i % 2, .method_2 = 1 - i % 2, .response = 1 + i % 2});
    return d;
}

TEST_CASE("missing trials are reported with their participants")
{
    dataset d;
    d.experiment.runs = {run("pairs", &find_task("choose"), 4)};
    d.participants = {"1", "2", "3", "4"};
    d.data = {{chosen(4)}, {chosen(3)}, {chosen(5)}, {chosen(0)}};
    const analysis a = analyse(d);
    CHECK(warns(a, "pairs: sub-2 has 3 trials that count, of 4"));
    CHECK(warns(a, "pairs: sub-3 has 5 trials that count, of 4"));
    CHECK(warns(a, "pairs: sub-4 is left out: no trial counts"));
    const auto named = std::count_if(a.warnings.begin(), a.warnings.end(), [](const std::string& w) {
        return w.find("that count, of") != std::string::npos;
    });
    CHECK(named == 2);
    d.experiment.runs[0].trials = 0; // the definition does not give their number
    CHECK_FALSE(warns(analyse(d), "pairs: sub-2 has 3 trials that count, of 0"));
}

// Adds four trials of two methods, in which the first of them was chosen so often.
void compare(run_data& r, std::size_t a, std::size_t b, unsigned times)
{
    for (unsigned i = 0; i < 4; ++i) // b begins every other trial
        r.trials.push_back({.place = static_cast<unsigned>(r.trials.size() + 1),
                            .method_1 = i % 2 == 0 ? a : b,
                            .method_2 = i % 2 == 0 ? b : a,
                            .response = (i < times) == (i % 2 == 0) ? 1U : 2U});
}

TEST_CASE("each of three methods has the per cent of its trials, and a worth or a warning")
{
    run_data r;
    compare(r, 0, 1, 1);
    compare(r, 2, 1, 3);
    compare(r, 2, 0, 3);
    dataset d;
    d.experiment.runs = {run("pairs", &find_task("choose"), 12)};
    d.experiment.runs[0].methods.emplace_back("c");
    d.participants = {"1", "2"};
    d.data = {{r}, {r}};
    const analysis a = analyse(d);
    const run_analysis& found = a.runs[0];
    const auto cells = list_values<cell_means>(found.results);
    REQUIRE(cells.size() == 3);
    for (std::size_t m = 0; m < 3; ++m)
        CHECK(*cells[m]->means[0].test.mean == doctest::Approx(25.0 * static_cast<double>(m + 1)));
    CHECK(*find_run_task(found.run).compare(found.run, r.trials).value == doctest::Approx(75.0));
    CHECK(*list_values<interval_share>(found.results)[0]->test.mean == doctest::Approx(75.0));
    const std::vector<worth> worths = fit_bradley_terry({{0, 2, 2}, {6, 0, 2}, {6, 6, 0}});
    for (std::size_t m = 0; m < 3; ++m)
        CHECK(*list_values<worth_list>(found.results)[0]->worths[m].log_worth == *worths[m].log_worth);
    CHECK(list_values<tukey_list>(found.results).empty());
    CHECK(list_values<effect_list>(found.results).empty());
    const std::string text = "pairs: worth of c: the choices between c and a, directly and through other "
                             "methods, all go one way or are missing, so this worth is not finite";
    CHECK_FALSE(warns(a, text));
    d.data[1][0].trials.clear();
    run_data& always = d.data[0][0] = {};
    compare(always, 0, 1, 1);
    compare(always, 2, 1, 4);
    compare(always, 2, 0, 4);
    const analysis without = analyse(d);
    CHECK(warns(without, text));
    CHECK(list_values<worth_list>(without.runs[0].results)[0]->worths[1].log_worth);
}

TEST_CASE("response times are medians of the participants' medians, and missing ones are left out")
{
    CHECK(!median({}));
    CHECK(*median({3.0, 1.0, 2.0}) == 2.0);
    CHECK(*median({4.0, 1.0, 2.0, 30.0}) == 3.0);
    dataset d;
    d.experiment.runs = {run("pairs", &find_task("choose"), 4), run("marks", &find_task("rate"), 4)};
    d.participants = {"1", "2", "3"};
    run_data slow = chosen(4);
    run_data quick = chosen(4);
    run_data untimed = chosen(4);
    for (std::size_t i = 0; i < 3; ++i) { // the fourth time is missing
        slow.trials[i].response_time_s = i == 0 ? 9.0 : 2.0;
        quick.trials[i].response_time_s = 0.5;
    }
    run_data marks = chosen(4); // method a in the second and fourth trial
    for (std::size_t i = 0; i < 4; ++i) {
        marks.trials[i].response_time_s = i % 2 == 1 ? 1.0 : 3.0;
        marks.trials[i].method_1 = 1 - i % 2;
    }
    d.data = {{slow, marks}, {quick, {}}, {untimed, {}}};
    const analysis a = analyse(d);
    const response_times& pairs = a.runs[0].times;
    CHECK(*pairs.median_s == 1.25); // of 2 and 0.5
    CHECK(pairs.by.size() == 1);
    CHECK(pairs.by[0].first == "m");
    CHECK(*pairs.by[0].second == 1.25);
    const response_times& ratings = a.runs[1].times;
    CHECK(*ratings.median_s == 2.0); // only the first participant is in the figures
    CHECK(ratings.by[0] == std::pair<std::string, std::optional<double>>("a:m", 1.0));
    CHECK(ratings.by[1] == std::pair<std::string, std::optional<double>>("b:m", 3.0));
    d.data = {{untimed, {}}, {untimed, {}}, {untimed, {}}};
    CHECK(!analyse(d).runs[0].times.median_s);
}

// The first method is always rated 1, the second 5, except for some fours.
run_data rated(unsigned trials, unsigned fours)
{
    run_data d;
    for (unsigned i = 0; i < 2 * trials; ++i)
        d.trials.push_back({.place = i + 1,
                            .method_1 = i % 2,
                            .response = i % 2 == 0      ? 1U
                                        : i / 2 < fours ? 4U
                                                        : 5U});
    return d;
}

TEST_CASE("an effect too large for an interval is reported")
{
    dataset d;
    d.experiment.runs = {run("marks", &find_task("rate"), 0)};
    d.participants = {"1", "2"};
    const std::string text = "marks: methods: the effect is too large for an interval";
    d.data = {{rated(2000, 0)}, {rated(2000, 1)}}; // t = 16000
    analysis a = analyse(d);
    CHECK(warns(a, text));
    const auto paired = [&a] { return list_values<method_difference>(a.runs[0].results)[0]->test; };
    CHECK(paired().t);
    CHECK_FALSE(paired().d_ci);
    d.data = {{rated(1000, 0)}, {rated(1000, 1)}}; // t = 8000
    a = analyse(d);
    CHECK_FALSE(warns(a, text));
    CHECK(paired().d_ci);
    d.data = {{rated(1000, 0)}, {rated(1000, 0)}}; // no t at all
    CHECK_FALSE(warns(analyse(d), text));
}

TEST_CASE("classical scaling finds points again from their distances, turned and mirrored")
{
    const std::vector<std::array<double, 2>> truth{
        {0.0, 0.0}, {30.0, 4.0}, {12.0, 40.0}, {-7.0, 21.0}, {5.0, 5.0}};
    const auto distance = [](const std::array<double, 2>& a, const std::array<double, 2>& b) {
        return std::hypot(a[0] - b[0], a[1] - b[1]);
    };
    std::vector<std::vector<double>> differences;
    for (const auto& a : truth) {
        differences.emplace_back();
        for (const auto& b : truth)
            differences.back().push_back(distance(a, b));
    }
    const scaled_items found = scale_items(differences);
    REQUIRE(found.places.size() == truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i)
        for (std::size_t k = 0; k < truth.size(); ++k)
            CHECK(distance(found.places[i], found.places[k]) ==
                  doctest::Approx(differences[i][k]).epsilon(1e-12));
    CHECK(found.stress < 1e-12);
    // The centre is at 0, and the first dimension is the longer one.
    double sum[2] = {};
    double squares[2] = {};
    for (const auto& place : found.places)
        for (int k : {0, 1}) {
            sum[k] += place[k];
            squares[k] += place[k] * place[k];
        }
    CHECK(std::abs(sum[0]) + std::abs(sum[1]) < 1e-10);
    CHECK(squares[0] > squares[1]);
    // Four items that are equally far apart do not fit into a plane.
    std::vector<std::vector<double>> equal(4, std::vector<double>(4, 10.0));
    for (std::size_t i = 0; i < 4; ++i)
        equal[i][i] = 0.0;
    CHECK(scale_items(equal).stress > 0.1);
    // Puts all at one place if nothing differs.
    for (const auto& place : scale_items({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}).places)
        CHECK(place == std::array{0.0, 0.0});
}

} // namespace
} // namespace tactor::study::test_statistics
