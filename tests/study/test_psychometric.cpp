// SPDX-License-Identifier: MIT
// Psychometric fits and sensitivities against published and recomputed values. Prints how many of the
// 95 % intervals of d' and exponents hold the truth; of 1,000 studies with TACTOR_SOAK=whole:
//   build-tests/tests/study/test-study -tc="*hold the truth*"
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "rounds.hpp"
#include "study/random/random.hpp"
#include "study/results/measures.hpp"
#include "study/results/result.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/statistics/signal_detection.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_psychometric {
namespace {

std::vector<answer_block> blocks(const std::vector<double>& x, std::size_t n,
                                 const std::vector<std::size_t>& k)
{
    std::vector<answer_block> all;
    for (std::size_t i = 0; i < x.size(); ++i)
        all.push_back({x[i], n, k[i]});
    return all;
}

std::vector<double> steps(double from, double step, int count)
{
    std::vector<double> all;
    for (int i = 0; i < count; ++i)
        all.push_back(from + i * step);
    return all;
}

double phi(double z)
{
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

void check(const psychometric_fit& fit, double threshold, double slope, double deviance)
{
    CHECK(fit.parameters.threshold == doctest::Approx(threshold).epsilon(1e-6));
    CHECK(fit.parameters.slope == doctest::Approx(slope).epsilon(1e-6));
    CHECK(fit.deviance == doctest::Approx(deviance).epsilon(1e-6));
    CHECK(!fit.step);
}

constexpr psychometric_family without_lapse{sigmoid::normal, 0.0, 0.0};
constexpr psychometric_family two_choices{sigmoid::normal, 0.5, 0.06};
const std::vector<double> seven = steps(-3.0, 1.0, 7);

TEST_CASE("psignifit's standard set")
{
    const auto standard =
        blocks({1e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3, 4.5e-3, 5e-3, 6e-3, 7e-3, 8e-3, 10e-3}, 90,
               {45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90});
    // Maximum likelihood, recomputed; psignifit's own estimates have priors.
    const auto normal = *fit_psychometric(standard, two_choices);
    check(normal, 4.647817e-3, 1.416257e-3, 5.93281305);
    CHECK(normal.parameters.lapse == 0.0);
    check(*fit_psychometric(standard, {sigmoid::logistic, 0.5, 0.06}), 4.633233e-3, 0.817966e-3, 7.09527732);
    const auto b = bootstrap_psychometric(standard, two_choices, normal, "standard");
    CHECK(b.threshold->first < 4.647817e-3);
    CHECK(b.threshold->second > 4.647817e-3);
    CHECK(*b.p_gof > 0.5);
}

TEST_CASE("ten levels without lapses")
{
    const std::vector<double> x = steps(0.25, 1.0 / 6.0, 10);
    check(*fit_psychometric(blocks(x, 10, {0, 2, 2, 3, 7, 7, 8, 8, 9, 10}), without_lapse), 0.89892610,
          0.43599963, 4.80985865);
    check(*fit_psychometric(blocks(x, 10, {4, 6, 3, 8, 7, 5, 8, 9, 9, 10}), {sigmoid::normal, 0.5, 0.0}),
          1.19192848, 0.34540835, 8.21836510);
    check(*fit_psychometric(blocks(x, 10, {5, 5, 5, 6, 5, 7, 9, 9, 8, 10}), {sigmoid::logistic, 0.5, 0.0}),
          1.18866409, 0.22919598, 4.12493144);
}

TEST_CASE("lapses move threshold and slope: Wichmann and Hill's example")
{
    const auto eight = blocks(steps(0.0, 60.0, 8), 20, {0, 0, 4, 18, 20, 20, 19, 20});
    const auto without = *fit_psychometric(eight, without_lapse);
    check(without, 151.05117661, 57.17587294, 20.89300909);
    CHECK(without.parameters.threshold + find_quartile(sigmoid::normal) * without.parameters.slope ==
          doctest::Approx(189.6157169).epsilon(1e-7));                                      // 75 %
    CHECK(find_quartile(sigmoid::logistic) == doctest::Approx(1.0986122887).epsilon(1e-9)); // ln 3
    const auto lapsing = *fit_psychometric(eight, {});
    check(lapsing, 142.97789392, 27.07164535, 2.86498355);
    CHECK(lapsing.parameters.lapse == doctest::Approx(0.01257566).epsilon(1e-6));
    CHECK(chance(162.0596614, lapsing.parameters, {}) == doctest::Approx(0.75).epsilon(1e-8));
    CHECK(*bootstrap_psychometric(eight, without_lapse, without, "eight").p_gof < 0.01);
    CHECK(*bootstrap_psychometric(eight, {}, lapsing, "eight").p_gof > 0.1);
}

TEST_CASE("fits are those of R's glm")
{
    // quickpsy's data (MIT): answers of three people to two kinds of pairs; deviance of single trials.
    // R 4.2.2 with epsilon = 1e-15: glm's own stops at four digits of the slope.
    struct person {
        std::size_t n;
        std::vector<std::size_t> k;
        double threshold;
        double slope;
        double deviance;
    };
    for (const person& p : {
             person{40, {2, 0, 1, 13, 32, 37, 36, 37}, -70.21747454, 78.48148496, 215.97694667},
             person{40, {1, 2, 10, 30, 37, 39, 40, 39}, -121.05530691, 61.72233903, 169.35076620},
             person{20, {0, 1, 2, 10, 18, 18, 20, 19}, -92.53564315, 67.18117328, 93.11075222},
             person{20, {0, 2, 8, 14, 20, 20, 20, 19}, -130.26832709, 66.13319715, 88.73178550},
             person{20, {0, 1, 3, 6, 16, 18, 20, 19}, -81.37293191, 69.24385978, 97.23446619},
             person{20, {1, 5, 8, 8, 18, 19, 20, 20}, -124.61735425, 78.89946578, 111.64255683},
         }) {
        std::vector<answer_block> trials;
        for (std::size_t i = 0; i < p.k.size(); ++i)
            for (std::size_t j = 0; j < p.n; ++j)
                trials.push_back({-250.0 + 50.0 * static_cast<double>(i), 1, j < p.k[i] ? 1U : 0U});
        check(*fit_psychometric(trials, without_lapse), p.threshold, p.slope, p.deviance);
    }
    check(*fit_psychometric(blocks(seven, 20, {1, 0, 4, 9, 14, 20, 18}), {sigmoid::logistic, 0.0, 0.0}),
          0.205460721435, 0.821995249432, 9.576427891255);
}

TEST_CASE("answers that are flat or fall have no fit; a step has a threshold alone")
{
    for (const auto& k : std::vector<std::vector<std::size_t>>{{10, 10, 10, 10, 10, 10, 10},
                                                               {19, 18, 15, 10, 5, 2, 0},
                                                               {0, 0, 0, 0, 0, 0, 0},
                                                               {20, 20, 20, 20, 20, 20, 20},
                                                               {20, 10, 0, 0, 0, 10, 20}})
        CHECK(!fit_psychometric(blocks(seven, 20, k), {}));
    CHECK(!fit_psychometric(blocks(seven, 20, {8, 9, 10, 10, 7, 8, 9}), two_choices));
    CHECK(!fit_psychometric({}, {}));
    CHECK(!fit_psychometric(blocks({1.0}, 20, {5}), {}));

    const auto step = blocks(seven, 20, {0, 0, 0, 0, 20, 20, 20});
    const auto fit = *fit_psychometric(step, {});
    CHECK(fit.step);
    CHECK(fit.parameters.threshold == doctest::Approx(0.5).epsilon(0.01));
    CHECK(!bootstrap_psychometric(step, {}, fit, "step").threshold);
    const auto through = *fit_psychometric(blocks(seven, 20, {0, 0, 0, 7, 20, 20, 20}), {});
    CHECK(through.step);
    CHECK(std::abs(through.parameters.threshold) < 0.1);

    // A slope near 0: many simulated sets fall.
    const auto shallow = blocks(seven, 20, {10, 9, 10, 11, 10, 10, 11});
    const auto none = bootstrap_psychometric(shallow, {}, *fit_psychometric(shallow, {}), "shallow");
    CHECK(none.failed > 100);
    CHECK(!none.threshold);
    CHECK(!none.p_gof);
}

TEST_CASE("a text seeds the bootstrap")
{
    const auto answers = blocks(seven, 20, {0, 1, 3, 10, 17, 19, 20});
    const auto fit = *fit_psychometric(answers, {});
    const auto b = bootstrap_psychometric(answers, {}, fit, "one");
    CHECK(b.threshold == bootstrap_psychometric(answers, {}, fit, "one").threshold);
    CHECK(b.threshold != bootstrap_psychometric(answers, {}, fit, "two").threshold);
    CHECK(b.failed == 0);
    CHECK(b.slope->first < fit.parameters.slope);
    CHECK(b.slope->second > fit.parameters.slope);
}

TEST_CASE("intervals of a mean d' and exponent hold the truth in 95 % of simulated studies")
{
    constexpr std::size_t people = 12;
    constexpr std::size_t trials = 60;
    constexpr double exponent = 0.6;
    for (const auto& [task, dprime] : {std::pair(&find_task("detect"), 1.5),
                                       {&find_task("same-different"), 2.0},
                                       {&find_task("oddity"), 2.5},
                                       {&find_task("estimate"), 0.0}}) {
        run_outline run{.name = "run", .file_name = "run", .task = task, .motions = {"m"}, .methods = {"a"}};
        run.catches = task == &find_task("detect");
        if (task == &find_task("estimate"))
            run.values = {5.0, 10.0, 20.0, 40.0};
        const auto simulate = [&](trial& t, random_numbers& r) {
            const double apart = t.signal ? dprime : 0.0;
            if (task == &find_task("estimate"))
                t.estimate = 10.0 * std::pow(t.value, exponent) * std::exp(0.2 * r.normal());
            else if (task == &find_task("oddity")) {
                const std::array x{apart + r.normal(), r.normal(), r.normal()};
                const auto between = [&x](std::size_t i, std::size_t k) { return std::abs(x[i] - x[k]); };
                t.positive = between(1, 2) < std::min(between(0, 1), between(0, 2)); // these two are alike
            } else if (task == &find_task("detect"))
                t.positive = apart + r.normal() > 0.5 * dprime;
            else
                t.positive = std::abs(apart + r.normal() - r.normal()) > 1.4;
        };
        random_numbers r(task->name());
        const int studies = test::rounds(200, 1000);
        int hold = 0;
        for (int study = 0; study < studies; ++study) {
            std::vector<std::vector<trial>> answers(people, std::vector<trial>(trials));
            std::vector<person_trials> all;
            for (std::vector<trial>& own : answers) {
                for (std::size_t i = 0; i < trials; ++i) {
                    own[i].signal = i % 2 == 0 || task == &find_task("oddity");
                    if (!run.values.empty())
                        own[i].value = run.values[i % run.values.size()];
                    simulate(own[i], r);
                }
                all.push_back({std::to_string(all.size()), &own});
            }
            const std::vector<result> rows = find_run_task(run).analyse(run, {all}, sigmoid::normal);
            const t_test mean =
                task == &find_task("estimate") ? list_values<exponents>(rows)[0]->figures[0].test
                : task == &find_task("oddity") ? list_values<oddities>(rows)[0]->figures[0].test
                                               : list_values<sensitivities>(rows)[0]->figures[0].test;
            const double truth = task == &find_task("estimate") ? exponent : dprime;
            hold += mean.ci && mean.ci->first <= truth && truth <= mean.ci->second ? 1 : 0;
        }
        fmt::print("{}, {} people of {} trials: of {} intervals {} hold the truth\n", task->name(), people,
                   trials, studies, hold);
        CHECK(hold >= studies * (test::whole() ? 93 : 85) / 100);
        CHECK(hold <= studies * (test::whole() ? 97 : 100) / 100);
    }
}

TEST_CASE("d' of three stimuli")
{
    // R's integrate() of Ennis's integral. The tables of the triangle test have 0.418 for 1 and 0.605 for 2.
    for (const auto& [dprime, share] : {std::pair(0.5, 0.355834650),
                                        {1.0, 0.418046675},
                                        {1.5, 0.506456097},
                                        {2.0, 0.604806933},
                                        {3.0, 0.781427599},
                                        {4.0, 0.897660380}}) {
        CHECK(triangle_share(dprime) == doctest::Approx(share).epsilon(3e-9));
        CHECK(triangle_dprime(share) == doctest::Approx(dprime).epsilon(1e-7));
    }
    // dprime.oddity() of R's package psyphy, to its four digits.
    for (const auto& [share, dprime] : {std::pair(0.418, 0.9997), {0.75, 2.7975}, {0.9, 4.0276}})
        CHECK(triangle_dprime(share) == doctest::Approx(dprime).epsilon(2e-5));
    CHECK(triangle_share(0.0) == doctest::Approx(1.0 / 3.0).epsilon(1e-14));
    CHECK(triangle_dprime(1.0 / 3.0) == 0.0);
    CHECK(triangle_dprime(0.2) == 0.0);
    CHECK(corrected_right_share({20, 60}) == doctest::Approx(1.0 / 3.0).epsilon(1e-14));
    CHECK(triangle_dprime(corrected_right_share({10000, 10000})) < 16.0);
}

TEST_CASE("sensitivities")
{
    const sensitivity corrected = yes_no_sensitivity(corrected_rate(20, 25), corrected_rate(0, 25));
    CHECK(corrected.dprime == doctest::Approx(2.87099636).epsilon(1e-8));
    CHECK(corrected.c == doctest::Approx(0.63440365).epsilon(1e-8));
    struct rates {
        double hits;
        double false_alarms;
        double dprime;
    };
    for (const rates& e :
         {rates{0.642, 0.3, 1.95061531}, rates{0.6, 0.2, 2.16161569}, rates{0.75, 0.3, 2.40588626},
          rates{0.8, 0.4, 2.34964949}, rates{0.9, 0.3, 3.27489950}, rates{0.99, 0.01, 6.93272545}})
        CHECK(same_different_sensitivity(e.hits, e.false_alarms).dprime ==
              doctest::Approx(e.dprime).epsilon(2e-9));
    CHECK(same_different_sensitivity(0.642, 0.3).c ==
          doctest::Approx(1.46573816).epsilon(1e-8)); // sqrt 2 times Phi^-1(0.85)
    CHECK(same_different_sensitivity(0.2, 0.3).dprime == 0.0);
    const std::vector<double> values{1, 2, 4, 4, 9};
    CHECK(*stevens_exponent(values, std::vector<double>{2, 3, 9, 10, 20}) ==
          doctest::Approx(1.118728530988).epsilon(1e-11)); // R's lm
    CHECK(!stevens_exponent(values, std::vector<double>{2, 3, 0, 10, 20}));
    CHECK(!stevens_exponent(std::vector<double>{3, 3}, std::vector<double>{1, 2}));
}

TEST_CASE("two answers of equal standing have lapses at both ends")
{
    const psychometric_family f = two_answer_family(sigmoid::normal);
    std::vector<answer_block> blocks;
    for (const double x : {-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0}) {
        const double share = 0.08 / 2.0 + (1.0 - 0.08) * phi((x - 0.4) / 1.7);
        CHECK(chance(x, {0.4, 1.7, 0.08}, f) == doctest::Approx(share).epsilon(1e-12));
        blocks.push_back({x, 100000000, static_cast<std::size_t>(std::lround(share * 1e8))});
    }
    const auto fit = *fit_psychometric(blocks, f);
    CHECK(fit.parameters.threshold == doctest::Approx(0.4).epsilon(1e-5));
    CHECK(fit.parameters.slope == doctest::Approx(1.7).epsilon(1e-5));
    CHECK(fit.parameters.lapse == doctest::Approx(0.08).epsilon(1e-4));
    CHECK(fit.deviance < 1e-3);

    std::vector<trial> trials;
    for (const answer_block& b : blocks)
        for (std::size_t i = 0; i < 1000; ++i)
            trials.push_back({.value = b.x, .positive = i < (b.k + 50000) / 100000});
    const fitted_function m = fit_comparisons(trials, sigmoid::normal, "");
    CHECK(*m.pse == doctest::Approx(0.4).epsilon(0.01));
    CHECK(*m.jnd == doctest::Approx(0.6744897501960817 * 1.7).epsilon(0.01));
}

TEST_CASE("the interval of a jnd is that of the slope in the unit of the jnd")
{
    const std::vector<std::size_t> answers{1, 2, 4, 10, 16, 18, 19}; // of 20 to the values -3 to 3
    std::vector<trial> trials;
    for (std::size_t k = 0; k < answers.size(); ++k)
        for (std::size_t i = 0; i < 20; ++i)
            trials.push_back({.value = static_cast<double>(k) - 3.0, .positive = i < answers[k]});
    // The distance from a half to three quarters, of the normal and of the logistic function.
    for (const auto& [kind, quartile] :
         {std::pair(sigmoid::normal, 0.6744897501960817), {sigmoid::logistic, 1.0986122886681098}}) {
        const fitted_function m = fit_comparisons(trials, kind, "jnd");
        REQUIRE(m.jnd_ci);
        CHECK(m.jnd_ci->first < *m.jnd);
        CHECK(m.jnd_ci->second > *m.jnd);
        CHECK(m.jnd_ci->first == doctest::Approx(quartile * m.bootstrap.slope->first).epsilon(1e-12));
        CHECK(m.jnd_ci->second == doctest::Approx(quartile * m.bootstrap.slope->second).epsilon(1e-12));
    }
}

TEST_CASE("the likelihood ratio of same-different answers is that of the counts")
{
    // G of a table of two rows: 2 sum of observed ln (observed / expected).
    const difference_counts one{30, 40, 18, 40};
    const double expected = 2.0 * (30 * std::log(30 / 24.0) + 10 * std::log(10 / 16.0) +
                                   18 * std::log(18 / 24.0) + 22 * std::log(22 / 16.0));
    const auto found = *test_difference(std::vector{one}, "a");
    CHECK(found.likelihood_ratio == doctest::Approx(expected).epsilon(1e-12));
    // Fisher's exact p of 30 hits or more among 48 answers: 0.00582 (by hand, from binomial coefficients).
    double tail = 0.0;
    double all = 0.0;
    for (int hits = 8; hits <= 40; ++hits) {
        const double chance = std::exp(-std::lgamma(hits + 1) - std::lgamma(41 - hits) -
                                       std::lgamma(49 - hits) - std::lgamma(hits - 7));
        all += chance;
        tail += hits >= 30 ? chance : 0.0;
    }
    CHECK(std::abs(found.p - tail / all) < 4.0 * std::sqrt(tail / all / 2000.0) + 1.0 / 2001.0);
    CHECK(found.studies == 2000);
    CHECK(found.p == test_difference(std::vector{one}, "a")->p);
    CHECK(found.p != test_difference(std::vector{one}, "b")->p);
    // Fewer hits than false alarms say nothing against d' = 0.
    CHECK(test_difference(std::vector<difference_counts>{{10, 40, 18, 40}}, "a")->likelihood_ratio == 0.0);
    CHECK(test_difference(std::vector<difference_counts>{{10, 40, 18, 40}}, "a")->p == 1.0);
    for (const difference_counts& edge : {difference_counts{0, 40, 0, 40}, {40, 40, 40, 40}, {5, 5, 0, 30}}) {
        const auto t = *test_difference(std::vector{edge}, "a");
        CHECK(t.p == doctest::Approx(edge.different == 5 ? 1.0 / 2001.0 : 1.0).epsilon(0.01));
    }
    CHECK(!test_difference({}, "a"));
}

TEST_CASE("the likelihood ratio of answers to three stimuli is that of the counts")
{
    const auto found = *test_oddity(std::vector<right_count>{{20, 36}, {10, 36}}, "a");
    // G of 20 right and 16 wrong answers where 12 and 24 are expected. 10 of 36 say nothing against d' = 0.
    CHECK(found.likelihood_ratio ==
          doctest::Approx(2.0 * (20 * std::log(20 / 12.0) + 16 * std::log(16 / 24.0))).epsilon(1e-12));
    // Exact p of one participant: 20 right answers or more of 36, binomial.
    double tail = 0.0;
    for (int k = 20; k <= 36; ++k)
        tail += std::exp(std::lgamma(37) - std::lgamma(k + 1) - std::lgamma(37 - k) - 36 * std::log(3.0) +
                         (36 - k) * std::log(2.0));
    const double p = test_oddity(std::vector<right_count>{{20, 36}}, "a")->p;
    CHECK(std::abs(p - tail) < 4.0 * std::sqrt(tail / 2000.0) + 1.0 / 2001.0);
    CHECK(test_oddity(std::vector<right_count>{{10, 36}}, "a")->p == 1.0);
    CHECK(!test_oddity({}, "a"));
}

} // namespace
} // namespace tactor::study::test_psychometric
