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

/// Returns the standard deviation (n - 1) of two values or more, given their mean.
double deviation(std::span<const double> values, double mean);

/// Returns the median; for an even number of values, the mean of both in the middle. Returns nothing without
/// values.
std::optional<double> median(std::vector<double> values);

/// A one-sample t test. A paired test is a test of the differences against 0. Figures are missing that n = 0,
/// n = 1 or equal values leave undefined.
struct t_test {
    std::size_t n = 0;
    std::optional<double> mean = {};
    std::optional<double> se = {};          ///< sd / sqrt n
    std::optional<interval> ci = {};        ///< of the mean
    std::optional<interval> ci_within = {}; ///< of the mean among other conditions: within_intervals()
    std::optional<double> t = {};           ///< of the mean, against `against`
    std::optional<double> df = {};          ///< n - 1
    std::optional<double> p = {};           ///< two-sided
    std::optional<double> p_signflip = {};  ///< exact, two-sided; needs no variance (sign_flip_p())
    std::optional<double> d = {};           ///< (mean - against) / sd
    std::optional<interval> d_ci = {};      ///< from the noncentral t distribution
};

/// Returns the mean with n, standard error and interval, without the test.
inline t_test without_test(const t_test& t) noexcept
{
    return {.n = t.n, .mean = t.mean, .se = t.se, .ci = t.ci};
}

/// Largest rounding error in a sum that should be 0, relative to the largest number in it.
inline constexpr double few_digits = 1e-12;

/// Returns true if the values differ by more than rounding: by more than few_digits of the largest, and by
/// more than `rounding` if they are differences of larger numbers.
bool varies(std::span<const double> values, double rounding = 0.0);

/// Tests the mean of finite values against a number; `rounding` as in varies().
t_test test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// Does the same without intervals, effect size and exact test, which take a thousand times as long.
t_test quick_test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// Returns the two-sided p of Student's t.
double p_of_t(double t, double df);

/// Returns the noncentralities with which 2.5 % and 97.5 % of noncentral t lie above t: the 95 % interval of
/// (mean - against) / se. Returns nothing if t is too large to compute (about 1e4).
std::optional<interval> noncentrality_interval(double t, double df);

/// Returns the 95 % interval of each condition's mean for comparisons between the conditions, without the
/// differences between participants: the interval of Cousineau (2005) with the correction of Morey (2008).
/// `values` has a row of all conditions for each participant. Intervals are missing for fewer than two
/// participants or conditions, and for a condition that does not vary; `rounding` as in varies().
std::vector<std::optional<interval>> within_intervals(const std::vector<std::vector<double>>& values,
                                                      double rounding = 0.0);

/// Returns p values adjusted by Holm (1979), in the order given; missing ones do not count and stay missing.
std::vector<std::optional<double>> holm(const std::vector<std::optional<double>>& p);

/// Returns the p of Fisher's exact test of differences: the share of all 2^n choices of signs that put the
/// sum of the values at least as far from 0 as the observed sum. Sums that differ only by rounding are equal.
/// Takes up to 40 values of any kind, and more if many sums are equal, as for percentages. Returns nothing
/// for more values, or for none.
std::optional<double> sign_flip_p(std::span<const double> values);

/// Returns the exact 95 % interval of Clopper and Pearson (1934) for the chance of an event that came `hits`
/// times in `n`; n is 1 or more.
interval binomial_interval(std::size_t hits, std::size_t n);

/// Values of each participant in each cell, for a repeated-measures analysis. In a row, the level of the
/// second factor changes fastest. All rows are as long as the product of the numbers of levels.
struct cell_table {
    std::vector<std::vector<double>> values = {}; ///< one row for each participant
    std::size_t first_levels = 1;                 ///< levels of the first factor; 1: there is only the second
    std::size_t second_levels = 1;
};

/// An effect, tested against its interaction with participants. Undefined figures are missing: all of them
/// with fewer than two participants or levels, and some if the error has no variance.
struct effect {
    double df1 = 0.0;
    double df2 = 0.0;
    std::optional<double> f = {};
    std::optional<double> p = {};
    std::optional<double> epsilon_gg = {}; ///< Greenhouse and Geisser 1959; this and the next 5: df1 >= 2
    std::optional<double> p_gg = {};
    std::optional<double> epsilon_hf = {}; ///< Huynh and Feldt 1976: may be above 1
    std::optional<double> p_hf = {};       ///< with 1 if epsilon_hf is above 1
    std::optional<double> mauchly_w = {};  ///< also needs n - 1 >= df1, and a matrix that is not singular
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

/// Computes both main effects and their interaction. A factor with one level has no effects.
anova repeated_measures(const cell_table& t);

struct mixed_anova {
    effect group;
    anova within;
    anova by_group; ///< interactions of the effects within participants with the group
};

/// Computes the effects of groups of participants and of both factors within participants, with sums of
/// squares of type III: an effect within participants is that of the mean of the groups' means, whatever the
/// sizes of the groups. Errors and epsilons come from the covariance within groups. Eta squared treats groups
/// as assigned, not as observed. `groups`: the group of each participant, from 0; no group is empty. Effects
/// are missing if no group has two participants.
mixed_anova analyse_groups(const cell_table& t, const std::vector<std::size_t>& groups);

/// Returns epsilon of Greenhouse and Geisser (1959), between 1 / rows and 1, from the cross products of
/// orthonormal contrasts (at least two; not all 0).
double greenhouse_geisser(const std::vector<std::vector<double>>& cross);

/// Returns epsilon of Huynh and Feldt (1976) as R 4.2 does (not with Lecoutre's correction), from the epsilon
/// of Greenhouse and Geisser for an effect with `df1` contrasts: ((df + 1) df1 epsilon - 2) / (df1 (df - df1
/// epsilon)). `df`: participants - groups. It may be above 1. Returns nothing if the divisor is 0, as with
/// two participants.
std::optional<double> huynh_feldt(double epsilon_gg, double df1, double df);

struct mauchly_test {
    double w;
    double p;
};

/// Computes Mauchly's test (1940) of equal variance of the differences between levels, with the second-order
/// correction of R's mauchly.test() and car. One term of the correction counts all `cells` of the design, not
/// the contrasts. `df`: participants - groups. Returns nothing if df is less than the number of contrasts, or
/// if the matrix is singular.
std::optional<mauchly_test> mauchly(const std::vector<std::vector<double>>& cross, std::size_t df,
                                    std::size_t cells);

/// Returns the chance that the range of `levels` (2 to 1000) standard normal variables, divided by an
/// independent estimate of their standard deviation with `df` degrees of freedom (1 or more), is above q. The
/// error is at most 1e-10, and some digits of small chances are right, too. Integrates in two dimensions;
/// takes a millisecond for few levels.
double studentized_range_p(double q, std::size_t levels, double df);

/// Returns angles, degrees, with whole turns added, so that they lie close together: the largest gap between
/// them is outside. Their mean is from -180 to 180.
std::vector<double> join_angles(std::vector<double> degrees);

struct comparison {
    std::size_t a;
    std::size_t b;     ///< after a
    double difference; ///< mean of a - mean of b
    std::optional<double> q = {};
    std::optional<double> p = {};
};

/// Compares all pairs of levels, in order. `ms_error` and `df` belong to the error against which the levels
/// are tested; each mean is over `n` values. Without an error above 0, computes only the differences.
std::vector<comparison> tukey(const std::vector<double>& means, std::size_t n, std::optional<double> ms_error,
                              double df);

/// A comparison of two levels by a paired t test.
struct paired_comparison {
    std::size_t a;
    std::size_t b;                     ///< after a
    t_test test = {};                  ///< of a less b, against 0
    std::optional<double> p_holm = {}; ///< adjusted for all pairs
};

/// Compares all pairs of levels, in order. Returns nothing without participants. `levels`: the participants'
/// values at each level; `rounding` as in varies(); `test`: test_mean() or quick_test_mean().
std::vector<paired_comparison> compare_pairs(const std::vector<std::vector<double>>& levels, double rounding,
                                             t_test (*test)(std::span<const double>, double against,
                                                            double rounding) = quick_test_mean);

} // namespace tactor::study
