// SPDX-License-Identifier: MIT
// QUEST+ against the examples of Watson (2017): the stimuli after given answers, and the means at the end.
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include "study/statistics/quest.hpp"

namespace tactor::study::test_quest {
namespace {

std::vector<double> range(int from, int to)
{
    std::vector<double> all;
    for (int i = from; i <= to; ++i)
        all.push_back(i);
    return all;
}

// Weibull in decibels; guesses are right in half of the trials.
double weibull(double x, const psychometric& p)
{
    return 1.0 - p.lapse - (0.5 - p.lapse) * std::exp(-std::pow(10.0, p.slope * (x - p.threshold) / 20.0));
}

double two_sided_normal(double x, const psychometric& p)
{
    return p.lapse +
           (1.0 - 2.0 * p.lapse) * 0.5 * std::erfc(-(x - p.threshold) / p.slope / std::numbers::sqrt2);
}

// Answers all trials, those of `wrong` (from 1) wrongly; returns the stimuli.
std::vector<double> simulate_answers(quest& q, std::size_t trials, const std::set<std::size_t>& wrong)
{
    std::vector<double> stimuli;
    for (std::size_t i = 1; i <= trials; ++i) {
        stimuli.push_back(q.stimulus());
        q.answer(!wrong.contains(i));
    }
    return stimuli;
}

void append(std::vector<double>& all, std::size_t times, double x)
{
    all.insert(all.end(), times, x);
}

TEST_CASE("example 1: the threshold alone")
{
    quest q({range(-40, 0), range(-40, 0), {}, {3.5}, {0.02}}, weibull);
    CHECK(q.expected_entropy() == doctest::Approx(3.562726828).epsilon(1e-9));
    quest before = q;
    simulate_answers(before, 31, {5, 6, 15, 18, 21});
    CHECK(before.expected_entropy() == doctest::Approx(1.678801504).epsilon(1e-9));
    CHECK(simulate_answers(q, 32, {5, 6, 15, 18, 21}) ==
          std::vector<double>{-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19,
                              -20, -21, -22, -23, -19, -20, -20, -18, -18, -19, -17,
                              -17, -18, -18, -18, -19, -19, -19, -19, -19, -19});
    CHECK(q.estimate().threshold == doctest::Approx(-20.393603116).epsilon(1e-9));
    CHECK(q.threshold_sd() == doctest::Approx(1.389334006).epsilon(1e-9));
}

TEST_CASE("threshold and slope")
{
    quest q({range(-40, 0), range(-40, 0), {}, range(2, 5), {0.02}}, weibull);
    CHECK(simulate_answers(q, 64, {2, 14, 17, 21, 26, 38, 41, 42, 47, 49, 53}) ==
          std::vector<double>{-18, -22, -12, -13, -15, -16, -17, -18, -19, -21, -24, -25, -26,
                              -27, -21, -22, -23, -20, -20, -20, -21, -19, -19, -20, -20, -20,
                              -19, -19, -19, -19, -19, -20, -20, -20, -20, -20, -21, -21, -20,
                              -20, -20, -19, -18, -18, -19, -19, -19, -18, -18, -17, -18, -18,
                              -18, -17, -17, -17, -17, -17, -17, -17, -18, -18, -18, -18});
    CHECK(q.estimate().threshold == doctest::Approx(-19.582425723).epsilon(1e-9));
    CHECK(q.estimate().slope == doctest::Approx(3.307536199).epsilon(1e-9));
}

TEST_CASE("example 2: threshold, slope and lapses; two stimuli that are equally good")
{
    quest q({range(-40, 0), range(-40, 0), {}, range(2, 5), {0.0, 0.01, 0.02, 0.03, 0.04}}, weibull);
    std::vector<double> stimuli = simulate_answers(
        q, 128, {5, 6, 15, 17, 25, 34, 44, 48, 57, 64, 78, 80, 85, 88, 96, 112, 116, 118, 119, 124});
    std::vector<double> right{-18, -22, -25, -28, -30, -21, -12, -14, -15, -16, -18, -19, -20, -22, -23,
                              -18, -19, -16, -17, -17, -18, -18, -18, -19, -19, -17, -17, -18, -18, -18,
                              -18, -19, -19, -20, -18, -18, -18, -18, -18, -19, -19, -19, -19, -20};
    append(right, 9, -18);
    append(right, 3, -19);
    append(right, 1, -20);
    append(right, 4, -18);
    append(right, 3, -19);
    append(right, 4, -18);
    append(right, 8, -19);
    right.insert(right.end(), {-20, -21});
    append(right, 7, -19);
    right.insert(right.end(), {-18, -19, -19});
    append(right, 6, -16);
    append(right, 2, 0); // or -2, whose entropies are equal to 12 digits
    append(right, 14, -19);
    append(right, 2, -21);
    append(right, 16, -19);
    for (const std::size_t i : {94U, 95U}) {
        CHECK(stimuli[i] >= -2.0);
        stimuli[i] = 0.0;
    }
    CHECK(stimuli == right);
    CHECK(q.estimate().threshold == doctest::Approx(-19.597275067).epsilon(1e-9));
    CHECK(q.estimate().slope == doctest::Approx(4.182297516).epsilon(1e-9));
    CHECK(q.estimate().lapse == doctest::Approx(0.027776517).epsilon(1e-8));
}

TEST_CASE("example 3: a normal with lapses at both ends")
{
    quest q({range(-10, 10), range(-5, 5), {}, range(1, 10), {0.0, 0.01, 0.02, 0.03, 0.04}},
            two_sided_normal);
    CHECK(simulate_answers(q, 128, {2,   3,   11,  13,  14,  15,  16,  19,  22,  23,  24,  26,  28,  29,
                                    31,  32,  34,  36,  37,  39,  43,  47,  48,  49,  50,  51,  53,  54,
                                    55,  56,  58,  59,  60,  62,  63,  65,  66,  67,  71,  72,  75,  77,
                                    78,  79,  82,  83,  84,  85,  86,  88,  89,  92,  95,  97,  100, 103,
                                    105, 106, 107, 108, 113, 115, 116, 117, 119, 120, 121, 122, 128}) ==
          std::vector<double>{0,  -1, 2,  -2, 2,  3,  3,  -5, 3,  3,  3,  3,  -7, -7, -7, -7, 4,  -7, 4,
                              4,  4,  -8, -8, -8, 4,  -8, 4,  -8, -7, 4,  -7, -7, 4,  -7, 4,  -7, -6, 3,
                              -4, -5, 3,  3,  -7, 2,  2,  1,  0,  -7, -6, -6, -6, 2,  -5, 2,  -6, -5, 3,
                              -5, -5, 3,  4,  -5, -5, 4,  -4, -4, -4, -4, 4,  3,  3,  4,  5,  5,  -5, 5,
                              -5, -5, 4,  5,  5,  -5, -4, -4, -4, -4, 5,  -4, -4, -3, 4,  4,  5,  5,  -4,
                              5,  -4, -4, 5,  4,  5,  5,  -5, 5,  -4, -4, -4, -4, 5,  -4, 5,  4,  -4, 4,
                              -4, -4, -4, 4,  -4, -4, -4, 4,  4,  -4, 4,  4,  4,  -4});
    CHECK(q.estimate().threshold == doctest::Approx(-0.102109611).epsilon(1e-8));
    CHECK(q.estimate().slope == doctest::Approx(4.176822235).epsilon(1e-9));
    CHECK(q.estimate().lapse == doctest::Approx(0.019346107).epsilon(1e-8));
}

TEST_CASE("weights of the thresholds count as answers do")
{
    const quest_grid equal{range(-40, 0), range(-40, 0), {}, {3.5}, {0.02}};
    quest q(equal, weibull);
    q.answer(true);
    quest_grid weighted = equal;
    for (const double t : equal.thresholds)
        weighted.weights.push_back(weibull(-18.0, {t, 3.5, 0.02}));
    const quest same(weighted, weibull);
    CHECK(same.stimulus() == q.stimulus());
    CHECK(same.estimate().threshold == doctest::Approx(q.estimate().threshold).epsilon(1e-12));
    CHECK(same.threshold_sd() == doctest::Approx(q.threshold_sd()).epsilon(1e-12));
}

} // namespace
} // namespace tactor::study::test_quest
