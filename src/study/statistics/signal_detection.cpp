// SPDX-License-Identifier: MIT
#include "study/statistics/signal_detection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/policies/policy.hpp>
#include <boost/math/special_functions/owens_t.hpp>
#include <boost/math/tools/roots.hpp>

#include "study/random/random.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

// Policy that computes in double; tests.cpp has the reason.
using in_double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using normal = boost::math::normal_distribution<double, in_double>;
using binomial = boost::math::binomial_distribution<double, in_double>;

double z(double rate)
{
    return boost::math::quantile(normal(), rate);
}

// Returns the log-likelihood of k of n answers at the rate k / n.
double log_likelihood(std::size_t k, std::size_t n)
{
    const auto part = [n](std::size_t count) {
        const auto c = static_cast<double>(count);
        return count > 0 ? c * std::log(c / static_cast<double>(n)) : 0.0;
    };
    return part(k) + part(n - k);
}

// Share of right answers if the three stimuli do not differ.
constexpr double third = 1.0 / 3.0;

// Returns 2 ln of the likelihood ratio of a participant's answers to three stimuli.
double likelihood_ratio(const right_count& c)
{
    const auto right = static_cast<double>(c.right);
    const auto all = static_cast<double>(c.trials);
    if (right <= third * all)
        return 0.0;
    return 2.0 * (log_likelihood(c.right, c.trials) - right * std::log(third) -
                  (all - right) * std::log(1.0 - third));
}

// Returns 2 ln of the likelihood ratio of a participant's same-different answers. If the rate of hits is
// above the rate of false alarms, some d' and criterion fit both rates exactly. Otherwise d' = 0 is most
// likely.
double likelihood_ratio(const difference_counts& c)
{
    if (c.hits * c.same <= c.false_alarms * c.different)
        return 0.0;
    return 2.0 * (log_likelihood(c.hits, c.different) + log_likelihood(c.false_alarms, c.same) -
                  log_likelihood(c.hits + c.false_alarms, c.different + c.same));
}

// Distribution of the likelihood ratio of a participant whose answers do not depend on the stimuli.
class drawn_ratios {
public:
    // Computes the distribution for answers "different" that fall on the pairs at random: hypergeometric.
    explicit drawn_ratios(const difference_counts& c)
    {
        const std::size_t answers = c.hits + c.false_alarms;
        const std::size_t most = std::min(answers, c.different);
        double chance = 1.0; // relative to the chance of the fewest hits
        double sum = 0.0;
        for (std::size_t hits = answers - std::min(answers, c.same); hits <= most; ++hits) {
            const std::size_t others = answers - hits;
            ratios_.push_back(likelihood_ratio(difference_counts{hits, c.different, others, c.same}));
            up_to_.push_back(sum += chance);
            chance *= static_cast<double>((c.different - hits) * others) /
                      static_cast<double>((hits + 1) * (c.same - others + 1));
        }
    }
    // Computes the distribution for answers of which a third is right by chance.
    explicit drawn_ratios(const right_count& c)
    {
        const auto trials = static_cast<double>(c.trials);
        double sum = 0.0;
        for (std::size_t right = 0; right <= c.trials; ++right) {
            ratios_.push_back(likelihood_ratio(right_count{right, c.trials}));
            up_to_.push_back(sum += boost::math::pdf(binomial(trials, third), static_cast<double>(right)));
        }
    }

    double draw(random_numbers& r) const
    {
        const auto at = std::ranges::upper_bound(up_to_, r.unit() * up_to_.back());
        return at == up_to_.end() ? ratios_.back() : ratios_[static_cast<std::size_t>(at - up_to_.begin())];
    }

private:
    std::vector<double> ratios_ = {}; ///< likelihood ratio for each number of hits or right answers
    std::vector<double> up_to_ = {};  ///< chance of this number or fewer, times a constant
};

// Compares the sum of the participants' likelihood ratios with the sums of simulated studies.
template <class Counts>
std::optional<difference_test> test_ratios(std::span<const Counts> people, std::string_view seed)
{
    constexpr std::size_t studies = 2000;
    if (people.empty())
        return {};
    double found = 0.0;
    std::vector<drawn_ratios> drawn;
    for (const Counts& c : people) {
        found += likelihood_ratio(c);
        drawn.emplace_back(c);
    }
    random_numbers r(seed);
    std::size_t as_large = 1;
    for (std::size_t i = 0; i < studies; ++i) {
        double sum = 0.0;
        for (const drawn_ratios& one : drawn)
            sum += one.draw(r);
        // The tolerance counts sums as equal if they differ only by rounding.
        as_large += sum >= found - 1e-9 * (1.0 + found) ? 1 : 0;
    }
    return difference_test{found, static_cast<double>(as_large) / static_cast<double>(studies + 1), studies};
}

} // namespace

double corrected_rate(std::size_t count, std::size_t n)
{
    return (static_cast<double>(count) + 0.5) / (static_cast<double>(n) + 1.0);
}

sensitivity yes_no_sensitivity(double hits, double false_alarms)
{
    const double h = z(hits);
    const double f = z(false_alarms);
    return {h - f, -(h + f) / 2.0};
}

sensitivity same_different_sensitivity(double hits, double false_alarms)
{
    // A difference of two observations has a standard deviation of sqrt 2.
    const double c = -std::numbers::sqrt2 * z(false_alarms / 2.0);
    if (hits <= false_alarms)
        return {0.0, c};
    const normal differences(c, std::numbers::sqrt2);
    const auto off = [&](double d) {
        return boost::math::cdf(differences, d) + boost::math::cdf(differences, -d) - hits;
    };
    // Upper bound: the root without the second term of off(), which is positive.
    const double most = c + std::numbers::sqrt2 * z(hits) + 1e-9;
    std::uintmax_t steps = 200;
    const auto [low, high] = boost::math::tools::toms748_solve(
        off, 0.0, most, boost::math::tools::eps_tolerance<double>(48), steps);
    return {(low + high) / 2.0, c};
}

double triangle_share(double dprime)
{
    // The mean of the odd stimulus differs by d' from the means of the two others. The odd stimulus is
    // farthest from both others if two normal variables have the same sign. Each variable has a mean of d' /
    // sqrt 6 and a variance of 1; the correlation of the variables is -1/2.
    return 1.0 - 4.0 * boost::math::owens_t(dprime / std::sqrt(6.0), std::numbers::sqrt3, in_double());
}

double triangle_dprime(double share)
{
    if (share <= third)
        return 0.0;
    constexpr double most = 20.0; // at this d', the share of wrong answers is below 1e-15
    std::uintmax_t steps = 200;
    const auto [low, high] =
        boost::math::tools::toms748_solve([share](double d) { return triangle_share(d) - share; }, 0.0, most,
                                          boost::math::tools::eps_tolerance<double>(48), steps);
    return (low + high) / 2.0;
}

double corrected_right_share(const right_count& c)
{
    return (static_cast<double>(c.right) + 0.5) / (static_cast<double>(c.trials) + 1.5);
}

std::optional<difference_test> test_difference(std::span<const difference_counts> people,
                                               std::string_view seed)
{
    return test_ratios(people, seed);
}

std::optional<difference_test> test_oddity(std::span<const right_count> people, std::string_view seed)
{
    return test_ratios(people, seed);
}

std::optional<double> stevens_exponent(std::span<const double> values, std::span<const double> estimates)
{
    const auto positive = [](double x) { return x > 0.0; };
    if (!varies(values) || !std::all_of(values.begin(), values.end(), positive) ||
        !std::all_of(estimates.begin(), estimates.end(), positive))
        return {};
    double x_mean = 0.0;
    for (const double value : values)
        x_mean += std::log(value) / static_cast<double>(values.size());
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = std::log(values[i]) - x_mean;
        xx += x * x;
        xy += x * std::log(estimates[i]);
    }
    return xy / xx;
}

} // namespace tactor::study
