// SPDX-License-Identifier: MIT
/// \file
/// The tests that studies report: t tests with effect sizes, analysis of variance, pairwise comparisons,
/// and exact tests and intervals.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tactor::study {

/// Both ends of a 95 % interval.
using interval = std::pair<double, double>;

/// Returns the mean of one value or more.
double mean(std::span<const double> values);

/// Returns the standard deviation (n - 1) of two values or more with this mean.
double deviation(std::span<const double> values, double mean);

/// Returns the median, of an even number the mean of both in the middle; nothing for no values.
std::optional<double> median(std::vector<double> values);

/// A one-sample t test; a paired test is that of the differences against 0. Figures that n = 0, n = 1 or no
/// variance leaves undefined are missing.
struct t_test {
    std::size_t n = 0;
    std::optional<double> mean = {};
    std::optional<double> se = {};          ///< sd / sqrt n
    std::optional<interval> ci = {};        ///< of the mean
    std::optional<interval> ci_within = {}; ///< of the mean among other conditions: within_intervals()
    std::optional<double> t = {};           ///< of the mean against what it was tested against
    std::optional<double> df = {};          ///< n - 1
    std::optional<double> p = {};           ///< two-sided
    std::optional<double> p_signflip = {};  ///< exact, two-sided; needs no variance (sign_flip_p())
    std::optional<double> d = {};           ///< (mean - against) / sd
    std::optional<interval> d_ci = {};      ///< from the noncentral t distribution
};

/// Part of the largest of some numbers that rounding may leave of 0 in their sum.
inline constexpr double few_digits = 1e-12;

/// Returns true if the values differ by more than what rounding makes of equal ones: some digits of the
/// values, and `rounding` where they are differences of larger ones.
bool varies(std::span<const double> values, double rounding = 0.0);

/// Tests the mean of finite values against a number; `rounding` as in varies().
t_test test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// The same without intervals, effect size and exact test, which take a thousand times as long.
t_test quick_test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// Returns the two-sided p of Student's t.
double p_of_t(double t, double df);

/// Returns the noncentralities with which 2.5 % and 97.5 % of noncentral t lie above t: the 95 % interval of
/// (mean - against) / se. Nothing where t is beyond what can be computed (some 1e4).
std::optional<interval> noncentrality_interval(double t, double df);

/// Returns the 95 % interval of each condition's mean for comparisons between the conditions, without the
/// differences between participants: that of Cousineau (2005) with the correction of Morey (2008). `values`:
/// a row of all conditions for each participant. Nothing with less than two participants or conditions, and
/// of a condition that does not vary; `rounding` as in varies().
std::vector<std::optional<interval>> within_intervals(const std::vector<std::vector<double>>& values,
                                                      double rounding = 0.0);

/// Returns p values adjusted by Holm (1979), in the order given; missing ones do not count and stay missing.
std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p);

/// Returns the p of Fisher's exact test of differences: the share of all 2^n choices of signs with which the
/// sum of the values is as far from 0 as it is, or farther. Exact: sums that differ by no more than rounding
/// are the same. Up to 40 values of any kind, and more where many sums are equal, as those of per cents are;
/// else nothing, as for no values.
std::optional<double> sign_flip_p(std::span<const double> values);

/// Returns the exact 95 % interval of Clopper and Pearson (1934) for the chance of what came `hits` times in
/// `n`; n is 1 or more.
interval binomial_interval(std::size_t hits, std::size_t n);

/// Values of every participant in every cell for a repeated-measures analysis, the cells of two factors by
/// rows: the second factor's levels follow each other. All rows are as long as the product of the levels.
struct cell_table {
    std::vector<std::vector<double>> values = {}; ///< one row for each participant
    std::size_t first_levels = 1;                 ///< of the first factor; 1: there is only the second
    std::size_t second_levels = 1;
};

/// An effect against its interaction with participants. Undefined figures are missing: all with less than two
/// participants or two levels, and those that need an error with variance.
struct effect {
    double df1 = 0.0;
    double df2 = 0.0;
    std::optional<double> f = {};
    std::optional<double> p = {};
    std::optional<double> epsilon_gg = {}; ///< Greenhouse and Geisser 1959; where df1 >= 2, as the next five
    std::optional<double> p_gg = {};
    std::optional<double> epsilon_hf = {}; ///< Huynh and Feldt 1976: may be above 1
    std::optional<double> p_hf = {};       ///< with 1 where that is above 1
    std::optional<double> mauchly_w = {};  ///< also where n - 1 >= df1 only, and not singular
    std::optional<double> mauchly_p = {};
    std::optional<double> eta2_partial = {};
    std::optional<double> eta2_generalised = {}; ///< SS / (SS + SS of participants + SS of all errors)
    std::optional<double> ms_error = {};         ///< 0 where the error has no variance
};

struct anova {
    effect first;
    effect second;
    effect interaction;
};

/// Computes both main effects and their interaction; of a factor with one level nothing.
anova repeated_measures(const cell_table& t);

struct mixed_anova {
    effect group;
    anova within;
    anova by_group; ///< interactions of the effects within participants with the group
};

/// Computes the effects of groups of participants and of both factors within participants, with sums of
/// squares of type III: an effect within participants is that of the mean of the groups' means, whatever
/// their sizes. Errors and epsilons come from the covariance within groups; eta squared counts groups as
/// assigned, not found. `groups`: of each participant, from 0; none is empty. Nothing where no group has two
/// participants.
mixed_anova analyse_groups(const cell_table& t, const std::vector<std::size_t>& groups);

/// Returns epsilon of Greenhouse and Geisser (1959), 1 / rows ... 1, from the cross products of orthonormal
/// contrasts (at least two; not all 0).
double greenhouse_geisser(const std::vector<std::vector<double>>& cross);

/// Returns epsilon of Huynh and Feldt (1976) as R does, from that of Greenhouse and Geisser for an effect
/// with `df1` contrasts: ((df + 1) df1 epsilon - 2) / (df1 (df - df1 epsilon)), `df`: participants - groups,
/// as in R 4.2 (not Lecoutre's correction). It may be above 1. Nothing where the divisor is 0, as with two
/// participants.
std::optional<double> huynh_feldt(double epsilon_gg, double df1, double df);

struct mauchly_test {
    double w;
    double p;
};

/// Computes Mauchly's test (1940) of equal variance of the differences between levels, with the correction to
/// the second order that R has, in mauchly.test() and in car: one of its terms counts all `cells` of the
/// design, not the contrasts. `df`: participants - groups. Nothing where df is less than the number of
/// contrasts, or the matrix is singular.
std::optional<mauchly_test> mauchly(const std::vector<std::vector<double>>& cross, std::size_t df,
                                    std::size_t cells);

/// Returns the chance that the range of `levels` (2 to 1000) standard normal variables, divided by an
/// independent estimate of their standard deviation with `df` degrees of freedom (1 or more), is above q. To
/// 1e-10, and also of small chances some digits are right. Integrates in two dimensions; a millisecond for
/// few levels.
double studentized_range_p(double q, std::size_t levels, double df);

/// A comparison of two levels.
struct comparison {
    std::size_t a;
    std::size_t b;     ///< after a
    double difference; ///< mean of a - mean of b
    std::optional<double> q = {};
    std::optional<double> p = {};
};

/// Compares all pairs of levels, in order. `ms_error` and `df` are of the error against which the levels are
/// tested, `n` values are in each mean; without an error that is above 0 differences only.
std::vector<comparison> tukey(const std::vector<double>& means, std::size_t n, std::optional<double> ms_error,
                              double df);

/// A comparison of two levels by a paired t test.
struct paired_comparison {
    std::size_t a;
    std::size_t b;                     ///< after a
    t_test test = {};                  ///< of a less b, against 0: quick_test_mean()
    std::optional<double> p_holm = {}; ///< adjusted for all pairs
};

/// Compares all pairs of levels, in order: nothing without participants. `levels`: of each level the
/// participants' values; `rounding` as in varies().
std::vector<paired_comparison> compare_pairs(const std::vector<std::vector<double>>& levels, double rounding);

} // namespace tactor::study
