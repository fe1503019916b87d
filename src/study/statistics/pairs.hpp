// SPDX-License-Identifier: MIT
/// \file
/// Comparisons of all pairs of levels or groups, with adjusted p values.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "study/statistics/tests.hpp"

namespace tactor::study {

/// Returns p values adjusted by the method of Holm (1979), in the given order. Missing p values do not count,
/// and stay missing.
std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p);

struct comparison {
    std::size_t a;
    std::size_t b;     ///< level after a
    double difference; ///< mean of a - mean of b
    std::optional<double> q = {};
    std::optional<double> p = {};
};

/// Compares all pairs of levels by Tukey's test, in order. `means`: mean of each level, each over `n` values.
/// `ms_error` and `df`: mean square and degrees of freedom of the error. If `ms_error` is missing or 0,
/// computes only the differences.
std::vector<comparison> tukey(const std::vector<double>& means, std::size_t n, std::optional<double> ms_error,
                              double df);

/// A comparison of two levels by a paired t test, or of two groups by an unpaired one.
struct paired_comparison {
    std::size_t a;
    std::size_t b;                     ///< level or group after a
    t_test test = {};                  ///< test of the difference a - b against 0
    std::optional<double> p_holm = {}; ///< adjusted for all pairs
};

/// Compares all pairs of levels, in order. Returns an empty list if there are no participants. `levels`: the
/// participants' values at each level. `rounding`: see varies(). `test`: test_mean() or test_mean_quickly().
std::vector<paired_comparison> compare_pairs(const std::vector<std::vector<double>>& levels, double rounding,
                                             t_test (*test)(std::span<const double>, double against,
                                                            double rounding) = test_mean_quickly);

/// Compares all pairs of groups of different participants, in order. Like R's pairwise.t.test(), uses one
/// standard deviation for all pairs, the pooled one of all groups; d is the difference divided by it. Figures
/// are missing if a group is empty, if no group has two values, or if no group's values vary. `groups`: the
/// values of each group's participants.
std::vector<paired_comparison> compare_group_pairs(const std::vector<std::vector<double>>& groups);

} // namespace tactor::study
