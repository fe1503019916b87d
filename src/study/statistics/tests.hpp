// SPDX-License-Identifier: MIT
/// \file
/// The tests that studies report: t tests with effect sizes, analysis of variance, exact tests and
/// intervals.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tactor::study {

/// Both ends of a 95 % interval.
using interval = std::pair<double, double>;

/// Returns the mean of one or more values.
double mean(std::span<const double> values);

/// Returns the standard deviation (divisor n - 1) of two or more values, given their mean.
double deviation(std::span<const double> values, double mean);

/// Returns the median; for an even number of values, the mean of the two middle values. Returns nothing if
/// there are no values.
std::optional<double> median(std::vector<double> values);

/// A one-sample t test. A paired t test is a one-sample test of the differences against 0. Figures are
/// missing if they are undefined because n is 0 or 1 or all values are equal.
struct t_test {
    std::size_t n = 0;
    std::optional<double> mean = {};
    std::optional<double> se = {};   ///< sd / sqrt n
    std::optional<interval> ci = {}; ///< interval of the mean
    std::optional<interval> ci_within =
        {};                       ///< within-participant interval of the mean: within_participant_intervals()
    std::optional<double> t = {}; ///< t of the mean against `against`
    std::optional<double> df = {};         ///< n - 1
    std::optional<double> p = {};          ///< two-sided
    std::optional<double> p_signflip = {}; ///< exact, two-sided, from sign_flip_p()
    std::optional<double> d = {};          ///< (mean - against) / sd
    std::optional<interval> d_ci = {};     ///< from the noncentral t distribution
};

/// Returns only n, mean, standard error and interval of the mean.
inline t_test omit_test(const t_test& t) noexcept
{
    return {.n = t.n, .mean = t.mean, .se = t.se, .ci = t.ci};
}

/// Largest rounding error in a sum that should be 0, relative to the largest summand.
inline constexpr double few_digits = 1e-12;

/// Returns true if the values differ by more than rounding errors: by more than few_digits times the largest
/// magnitude, and by more than `rounding`. `rounding`: error of values that are differences of larger
/// numbers.
bool varies(std::span<const double> values, double rounding = 0.0);

/// Tests the mean of finite values against a number. `rounding`: see varies().
t_test test_mean(std::span<const double> values, double against, double rounding = 0.0);

/// Does the same as test_mean(), but without intervals, effect size and exact test, which take a thousand
/// times as long.
t_test test_mean_quickly(std::span<const double> values, double against, double rounding = 0.0);

/// Returns the two-sided p of Student's t.
double t_p_value(double t, double df);

/// Returns the 97.5 % quantile of Student's t.
double t_quantile(double df);

/// Returns the 95 % interval of (mean - against) / se: the noncentralities for which 2.5 % and 97.5 % of the
/// noncentral t distribution are above t. Returns nothing if the magnitude of t is above 1e4.
std::optional<interval> noncentrality_interval(double t, double df);

/// Returns the 95 % within-participant interval of each condition's mean (Cousineau 2005, with the correction
/// of Morey 2008). These intervals serve to compare conditions, because they leave out the differences
/// between participants. `values`: for each participant, a row with the values of all conditions. `rounding`:
/// see varies(). Intervals are missing if there are fewer than two participants or conditions, or if the
/// values of a condition do not vary.
std::vector<std::optional<interval>>
within_participant_intervals(const std::vector<std::vector<double>>& values, double rounding = 0.0);

/// Returns the p of Fisher's exact test of differences: the share of all 2^n choices of signs for which the
/// sum of the values is at least as far from 0 as the observed sum. Sums that differ only by rounding count
/// as equal. Accepts up to 40 values, or more if many sums are equal, for instance sums of percentages.
/// Returns nothing for more values, or if there are no values.
std::optional<double> sign_flip_p(std::span<const double> values);

/// Returns the exact 95 % interval of Clopper and Pearson (1934) for the chance of an event that occurred in
/// `hits` of `n` trials; n is 1 or more.
interval binomial_interval(std::size_t hits, std::size_t n);

/// Values of each participant in each cell, for a repeated-measures analysis. In a row, the level of the
/// second factor changes fastest. Each row has first_levels * second_levels values.
struct cell_table {
    std::vector<std::vector<double>> values = {}; ///< one row for each participant
    /// Number of levels of the first factor; 1 if there is only a second factor.
    std::size_t first_levels = 1;
    std::size_t second_levels = 1;
};

/// An effect, tested against the interaction of this effect with participants. Undefined figures are missing:
/// all figures if there are fewer than two participants or levels, and some figures if the error has no
/// variance.
struct effect {
    double df1 = 0.0;
    double df2 = 0.0;
    std::optional<double> f = {};
    std::optional<double> p = {};
    /// Epsilon of Greenhouse and Geisser (1959). This and the next five figures exist only if df1 >= 2.
    std::optional<double> epsilon_gg = {};
    std::optional<double> p_gg = {};
    std::optional<double> epsilon_hf = {}; ///< Huynh and Feldt 1976: may be above 1
    std::optional<double> p_hf = {};       ///< p with an epsilon of 1 if epsilon_hf is above 1
    std::optional<double> mauchly_w = {};  ///< also needs n - 1 >= df1 and a non-singular covariance matrix
    std::optional<double> mauchly_p = {};
    std::optional<double> eta2_partial = {};
    std::optional<double> eta2_generalised = {}; ///< SS / (SS + SS of participants + SS of all errors)
    std::optional<double> ms_error = {};         ///< mean square of the error; 0 without variance
};

struct anova {
    effect first;
    effect second;
    effect interaction;
};

/// Computes both main effects and their interaction. A factor with one level has no effect.
anova analyse_repeated_measures(const cell_table& t);

struct mixed_anova {
    effect group;
    anova within;
    anova by_group; ///< interactions of group with the effects in `within`
};

/// Computes the effects of groups of participants and of both factors within participants. Uses sums of
/// squares of type III: an effect within participants is an effect on the mean of the groups' means, in which
/// all groups have equal weight. Errors and epsilons come from the covariance within groups. Eta squared
/// treats groups as assigned, not as observed. `groups`: the group of each participant, from 0; no group is
/// empty. Effects are missing if no group has two participants.
mixed_anova analyse_groups(const cell_table& t, const std::vector<std::size_t>& groups);

/// Returns epsilon of Greenhouse and Geisser (1959), between 1 / rows and 1. `cross`: cross products of at
/// least two orthonormal contrasts; not all 0.
double greenhouse_geisser_epsilon(const std::vector<std::vector<double>>& cross);

/// Returns epsilon of Huynh and Feldt (1976) as R 4.2 does, without Lecoutre's correction: ((df + 1) df1
/// epsilon_gg - 2) / (df1 (df - df1 epsilon_gg)). The result may be above 1. `df1`: number of contrasts of
/// the effect. `df`: participants - groups. Returns nothing if the divisor is 0, for instance with two
/// participants.
std::optional<double> huynh_feldt_epsilon(double epsilon_gg, double df1, double df);

struct mauchly_test {
    double w;
    double p;
};

/// Computes Mauchly's test (1940) of sphericity: all differences between levels have equal variances. Uses
/// the second-order correction of R's mauchly.test() and car. One term of the correction contains the
/// number of `cells` of the design, not the number of contrasts. `df`: participants - groups. Returns nothing
/// if df is less than the number of contrasts, or if the matrix is singular.
std::optional<mauchly_test> test_sphericity(const std::vector<std::vector<double>>& cross, std::size_t df,
                                            std::size_t cells);

/// Returns the chance that the studentized range is above q. This is the range of `levels` (2 to 1000)
/// standard normal variables, divided by an independent estimate of their standard deviation with `df` (1 or
/// more) degrees of freedom. The error is at most 1e-10. Chances below 1e-10 still have some right digits.
/// Integrates in two dimensions, which takes a millisecond for few levels.
double studentized_range_p(double q, std::size_t levels, double df);

/// Adds whole turns to angles, degrees, so that the angles lie as close together as
/// possible: the range from the smallest to the largest angle does not contain the largest gap. The mean of
/// the results is from -180 to 180.
std::vector<double> unwrap_angles(std::vector<double> degrees);

} // namespace tactor::study
