// SPDX-License-Identifier: MIT
#include "study/statistics/tests.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>

#include "study/statistics/precision.hpp"

namespace tactor::study {
namespace {

// Returns the noncentrality with which P(T <= t) is `below`: P falls as the noncentrality grows.
double noncentrality(double t, double df, double below)
{
    const auto off = [&](double delta) {
        return boost::math::cdf(boost::math::non_central_t_distribution<double, in_double>(df, delta), t) -
               below;
    };
    // Near t, as wide as the estimate of a standard deviation is uncertain.
    double width = 1.0 + std::abs(t) / std::sqrt(df);
    double low = t - width;
    double high = t + width;
    while (off(low) < 0.0)
        low -= width *= 2.0;
    width = 1.0 + std::abs(t) / std::sqrt(df);
    while (off(high) > 0.0)
        high += width *= 2.0;
    std::uintmax_t steps = 200;
    const auto [a, b] = boost::math::tools::toms748_solve(
        off, low, high, boost::math::tools::eps_tolerance<double>(48), steps);
    return (a + b) / 2.0;
}

struct share {
    double sum;
    double weight; ///< part of all choices of signs: a multiple of a power of two, so exact
};

constexpr std::size_t most_sums = std::size_t{1} << 20;

// Lists the sums of the values with either sign, in order and each once; empty if there are too many.
std::vector<share> all_sums(std::span<const double> values, double equal)
{
    std::vector<share> sums{{0.0, 1.0}};
    for (const double v : values) {
        std::vector<share> both;
        both.reserve(2 * sums.size());
        const auto moved = [&](double by) {
            std::vector<share> m = sums;
            for (share& s : m)
                s = {s.sum + by, s.weight / 2.0};
            return m;
        };
        const std::vector<share> down = moved(-std::abs(v));
        const std::vector<share> up = moved(std::abs(v));
        std::merge(down.begin(), down.end(), up.begin(), up.end(), std::back_inserter(both),
                   [](const share& a, const share& b) { return a.sum < b.sum; });
        sums.clear();
        for (const share& s : both)
            if (!sums.empty() && s.sum - sums.back().sum <= equal)
                sums.back().weight += s.weight;
            else
                sums.push_back(s);
        if (sums.size() > most_sums)
            return {};
    }
    return sums;
}

} // namespace

double mean(std::span<const double> values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(std::span<const double> values, double mean)
{
    double squares = 0.0;
    for (const double x : values)
        squares += (x - mean) * (x - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

bool varies(std::span<const double> values, double rounding)
{
    double largest = 0.0;
    double low = values.empty() ? 0.0 : values[0];
    double high = low;
    for (const double x : values) {
        largest = std::max(largest, std::abs(x));
        low = std::min(low, x);
        high = std::max(high, x);
    }
    return high - low > std::max(few_digits * largest, rounding);
}

double p_of_t(double t, double df)
{
    const boost::math::students_t_distribution<double, in_double> dist(df);
    return std::min(1.0, 2.0 * boost::math::cdf(boost::math::complement(dist, std::abs(t))));
}

std::optional<interval> noncentrality_interval(double t, double df)
{
    if (!(std::abs(t) <= 1e4))
        return {};
    return interval{noncentrality(t, df, 0.975), noncentrality(t, df, 0.025)};
}

t_test quick_test_mean(std::span<const double> values, double against, double rounding)
{
    t_test r;
    r.n = values.size();
    if (values.empty())
        return r;
    r.mean = mean(values);
    if (values.size() < 2)
        return r;
    r.df = static_cast<double>(r.n - 1);
    if (!varies(values, rounding)) {
        r.se = 0.0;
        return r;
    }
    r.se = deviation(values, *r.mean) / std::sqrt(static_cast<double>(r.n));
    r.t = (*r.mean - against) / *r.se;
    r.p = p_of_t(*r.t, *r.df);
    return r;
}

t_test test_mean(std::span<const double> values, double against, double rounding)
{
    t_test r = quick_test_mean(values, against, rounding);
    if (values.size() < 2)
        return r;
    // Signs mean nothing where the difference is rounding's alone.
    std::vector<double> off(values.begin(), values.end());
    for (double& x : off) {
        const double least = std::max(few_digits * std::max(std::abs(x), std::abs(against)), rounding);
        x -= against;
        if (std::abs(x) <= least)
            x = 0.0;
    }
    r.p_signflip = sign_flip_p(off);
    if (!r.t)
        return r;
    const double root_n = std::sqrt(static_cast<double>(r.n));
    const double sd = deviation(values, *r.mean);
    const double wide =
        boost::math::quantile(boost::math::students_t_distribution<double, in_double>(*r.df), 0.975) * *r.se;
    r.ci = interval{*r.mean - wide, *r.mean + wide};
    r.d = (*r.mean - against) / sd;
    if (const auto delta = noncentrality_interval(*r.t, *r.df))
        r.d_ci = interval{delta->first / root_n, delta->second / root_n};
    return r;
}

std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p)
{
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p[i])
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return *p[a] < *p[b]; });
    std::vector<std::optional<double>> adjusted(p.size());
    double least = 0.0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        least = std::max(least, std::min(1.0, static_cast<double>(order.size() - rank) * *p[order[rank]]));
        adjusted[order[rank]] = least;
    }
    return adjusted;
}

std::optional<double> sign_flip_p(std::span<const double> values)
{
    double all = 0.0;
    double observed = 0.0;
    for (const double v : values) {
        all += std::abs(v);
        observed += v;
    }
    if (values.empty())
        return {};
    // A sum of one half and one of the other make each sum of all.
    const std::vector<share> first = all_sums(values.first(values.size() / 2), 1e-12 * all);
    const std::vector<share> second = all_sums(values.subspan(values.size() / 2), 1e-12 * all);
    if (first.empty() || second.empty())
        return {};
    // The count at or above |observed| is the count at or below -|observed|: signs come in opposites.
    const double limit = std::abs(observed) - 1e-9 * all;
    if (limit <= 0.0)
        return 1.0;
    double above = 0.0;
    double taken = 0.0;
    std::size_t at = second.size();
    for (const share& s : first) {
        while (at > 0 && s.sum + second[at - 1].sum >= limit)
            taken += second[--at].weight;
        above += s.weight * taken;
    }
    return std::min(1.0, 2.0 * above);
}

interval binomial_interval(std::size_t hits, std::size_t n)
{
    using boost::math::binomial_distribution;
    constexpr double tail = 0.025;
    const auto trials = static_cast<double>(n);
    const auto successes = static_cast<double>(hits);
    return {binomial_distribution<double, in_double>::find_lower_bound_on_p(trials, successes, tail),
            binomial_distribution<double, in_double>::find_upper_bound_on_p(trials, successes, tail)};
}

} // namespace tactor::study
