// SPDX-License-Identifier: MIT
/// \file
/// Sensitivity by signal detection theory, and the exponent of magnitude estimates.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace tactor::study {

/// Returns (count + 0.5) / (n + 1). This log-linear correction (Hautus 1995) avoids rates of 0 and 1.
double corrected_rate(std::size_t count, std::size_t n);

struct sensitivity {
    double dprime;
    double c; ///< criterion in the unit of d'
};

/// Computes d' = z(hits) - z(false alarms) and c = -(z(hits) + z(false alarms)) / 2 of yes-no answers, with
/// equal variances. Both rates must be above 0 and below 1.
sensitivity yes_no_sensitivity(double hits, double false_alarms);

/// Computes d' of same-different answers by the differencing model (Macmillan and Creelman 2005). c is the
/// smallest difference that participants call "different". `hits` and `false_alarms`: rates of the answer
/// "different" to different pairs and to same pairs; both must be above 0 and below 1. If `hits` is not above
/// `false_alarms`, d' is 0, because the model cannot have such rates.
sensitivity same_different_sensitivity(double hits, double false_alarms);

/// Numbers of a participant's answers "different": hits for different pairs, false alarms for same pairs.
struct difference_counts {
    std::size_t hits = 0;
    std::size_t different = 0; ///< number of different pairs
    std::size_t false_alarms = 0;
    std::size_t same = 0; ///< number of same pairs
};

/// Returns the share of right answers in the triangular model (Ennis 1993). From three stimuli, an observer
/// with this d' picks the stimulus that feels most different from the two others.
double triangle_share(double dprime);

/// Returns the d' for which triangle_share() is `share`. Returns 0 for a share of 1/3 or less, because the
/// model has no smaller share. `share` must be below 1.
double triangle_dprime(double share);

/// Number of a participant's right answers.
struct right_count {
    std::size_t right = 0;
    std::size_t trials = 0;
};

/// Returns (right + 1/2) / (trials + 3/2). This share of right answers is never 1, and a share of 1/3 stays
/// 1/3.
double corrected_right_share(const right_count& c);

/// A test of whether any participant can tell the stimuli apart. A t test of d' would not work: d' is never
/// below 0, so the mean of d' is above 0 even if the stimuli do not differ.
struct difference_test {
    double likelihood_ratio; ///< 2 ln of the ratio, summed over participants: d' >= 0 against d' = 0
    double p;                ///< (1 + number of simulated ratios at least as large) / (1 + studies)
    std::size_t studies;     ///< number of simulated studies
};

/// Tests the hypothesis d' = 0 in the differencing model. In each simulated study, each participant says
/// "different" as often as in the real study, but in trials drawn at random. So p does not depend on an
/// estimated criterion. The text `seed` determines the draws. Returns nothing without participants.
std::optional<difference_test> test_difference(std::span<const difference_counts> people,
                                               std::string_view seed);

/// Tests the hypothesis d' = 0 in the triangular model. In each simulated study, each answer is right with a
/// chance of 1/3. Seed and result are as for test_difference().
std::optional<difference_test> test_oddity(std::span<const right_count> people, std::string_view seed);

/// Returns the exponent of Stevens's power law: the least-squares slope of log estimates over log values. The
/// exponent does not change if all estimates are divided by their geometric mean. Returns nothing if all
/// values are equal, or if a number is not above 0. Both spans have the same length.
std::optional<double> stevens_exponent(std::span<const double> values, std::span<const double> estimates);

} // namespace tactor::study
