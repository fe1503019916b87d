// SPDX-License-Identifier: MIT
/// \file
/// Tukey's pairwise comparisons, and the distribution that they need.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tactor::study {

/// The chance that the range of `levels` (2 to 1000) standard normal variables, divided by an independent
/// estimate of their standard deviation with `df` degrees of freedom (1 or more), is above q. To 1e-10, and
/// also of small chances some digits are right. Integrates in two dimensions; a millisecond for few levels.
double studentized_range_p(double q, std::size_t levels, double df);

/// Two levels compared.
struct comparison {
    std::size_t a;
    std::size_t b;     ///< after a
    double difference; ///< mean of a - mean of b
    std::optional<double> q = {};
    std::optional<double> p = {};
};

/// All pairs of levels, in order. `ms_error` and `df` are of the error against which the levels are tested,
/// `n` values are in each mean; without an error that is above 0 differences only.
std::vector<comparison> tukey(const std::vector<double>& means, std::size_t n, std::optional<double> ms_error,
                              double df);

} // namespace tactor::study
