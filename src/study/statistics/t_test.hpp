// SPDX-License-Identifier: MIT
/// \file
/// One-sample t tests with what goes with them; a paired test is that of the differences against 0.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tactor::study {

/// Both ends of a 95 % interval.
using interval = std::pair<double, double>;

/// Of some numbers. What n = 1 or no variance leaves undefined is not there; so is all where n = 0.
struct t_test {
    std::size_t n = 0;
    std::optional<double> mean = {};
    std::optional<double> se = {};         ///< sd / sqrt n
    std::optional<interval> ci = {};       ///< of the mean
    std::optional<double> t = {};          ///< of the mean against what it was tested against
    std::optional<double> df = {};         ///< n - 1
    std::optional<double> p = {};          ///< two-sided
    std::optional<double> p_signflip = {}; ///< exact, two-sided; needs no variance (sign_flip.hpp)
    std::optional<double> d = {};          ///< (mean - against) / sd
    std::optional<interval> d_ci = {};     ///< from the noncentral t distribution
};

/// Parts of the numbers that rounding may leave of nothing, where they were added up.
inline constexpr double few_digits = 1e-12;

/// Whether the values differ by more than what rounding makes of equal ones: some digits of the values, and
/// `rounding` where they are differences of larger ones.
bool varies(std::span<const double> values, double rounding = 0.0);

/// Tests the mean of finite values against a number; `rounding` as in varies().
t_test test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// The same without intervals, effect size and exact test, which take a thousand times as long.
t_test quick_test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// Two-sided p of Student's t.
double p_of_t(double t, double df);

/// The noncentralities with which 2.5 % and 97.5 % of noncentral t lie above t: the 95 % interval of
/// (mean - against) / se. Nothing where t is beyond what can be computed (some 1e4).
std::optional<interval> noncentrality_interval(double t, double df);

/// p values adjusted by Holm (1979), in the order given; those that are not there neither count nor get one.
std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p);

} // namespace tactor::study
