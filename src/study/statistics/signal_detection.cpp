// SPDX-License-Identifier: MIT
#include "study/statistics/signal_detection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/policies/policy.hpp>
#include <boost/math/tools/roots.hpp>

#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

// In double: as in tests.cpp.
using in_double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using normal = boost::math::normal_distribution<double, in_double>;

double z(double rate)
{
    return boost::math::quantile(normal(), rate);
}

} // namespace

double corrected_rate(std::size_t count, std::size_t n)
{
    return (static_cast<double>(count) + 0.5) / (static_cast<double>(n) + 1.0);
}

sensitivity yes_no(double hits, double false_alarms)
{
    const double h = z(hits);
    const double f = z(false_alarms);
    return {h - f, -(h + f) / 2.0};
}

sensitivity same_different(double hits, double false_alarms)
{
    // A difference of two observations has a standard deviation of sqrt 2.
    const double c = -std::numbers::sqrt2 * z(false_alarms / 2.0);
    if (hits <= false_alarms)
        return {0.0, c};
    const normal differences(c, std::numbers::sqrt2);
    const auto off = [&](double d) {
        return boost::math::cdf(differences, d) + boost::math::cdf(differences, -d) - hits;
    };
    // Without the second term, which is positive.
    const double most = c + std::numbers::sqrt2 * z(hits) + 1e-9;
    std::uintmax_t steps = 200;
    const auto [low, high] = boost::math::tools::toms748_solve(
        off, 0.0, most, boost::math::tools::eps_tolerance<double>(48), steps);
    return {(low + high) / 2.0, c};
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
