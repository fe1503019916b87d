// SPDX-License-Identifier: MIT
#include "study/statistics/binomial.hpp"

#include <boost/math/distributions/binomial.hpp>

namespace tactor::study {

interval binomial_interval(std::size_t hits, std::size_t n)
{
    using boost::math::binomial_distribution;
    constexpr double tail = 0.025;
    const auto trials = static_cast<double>(n);
    const auto successes = static_cast<double>(hits);
    return {binomial_distribution<>::find_lower_bound_on_p(trials, successes, tail),
            binomial_distribution<>::find_upper_bound_on_p(trials, successes, tail)};
}

} // namespace tactor::study
