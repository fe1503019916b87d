// SPDX-License-Identifier: MIT
/// \file
/// Sensitivity by signal detection theory, and the exponent of magnitude estimates.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace tactor::study {

/// Returns (count + 0.5) / (n + 1), the log-linear correction (Hautus 1995) that keeps a rate off 0 and 1.
double corrected_rate(std::size_t count, std::size_t n);

struct sensitivity {
    double dprime;
    double c; ///< criterion in the unit of d'
};

/// Computes d' = z(hits) - z(false alarms) and c = -(z(hits) + z(false alarms)) / 2 of yes-no answers with
/// equal variances, from rates above 0 and below 1.
sensitivity yes_no(double hits, double false_alarms);

/// Computes d' of same-different answers by the differencing model (Macmillan and Creelman 2005), from the
/// rates of "different" to different and to same pairs, above 0 and below 1. c is the least difference that
/// is called "different". If hits are not above false alarms, d' is 0, because the model has no such rates.
sensitivity same_different(double hits, double false_alarms);

/// Numbers of answers "different" of a participant, to pairs that differed and to pairs that did not.
struct difference_counts {
    std::size_t hits = 0;
    std::size_t different = 0; ///< pairs
    std::size_t false_alarms = 0;
    std::size_t same = 0; ///< pairs
};

/// Returns the share of right answers of an observer with this d' who picks, of three stimuli, the one that
/// is felt farthest from the two others: the triangular model (Ennis 1993).
double triangle_share(double dprime);

/// Returns the d' with which triangle_share() is `share`, below 1; 0 for a third and less, because the model
/// has no smaller share.
double triangle_dprime(double share);

/// A participant's answers that were right.
struct right_count {
    std::size_t right = 0;
    std::size_t trials = 0;
};

/// Returns (right + 1/2) / (trials + 3/2). Half an answer more for each of three answers keeps the share off
/// 1, and leaves a third as it is.
double corrected_third(const right_count& c);

/// A test of whether anybody can tell the stimuli apart. A t test of d' does not work: d' is never below 0,
/// so its mean is above 0 even without a difference.
struct difference_test {
    double likelihood_ratio; ///< 2 ln of the ratio, summed over participants: d' >= 0 against d' = 0
    double p;                ///< (1 + simulated ratios at least as large) / (1 + all)
    std::size_t studies;     ///< number of simulated studies
};

/// Tests d' = 0 of the differencing model. In each simulated study, each participant says "different" as
/// often as they really did, but in trials drawn at random, so p needs no estimate of a criterion. The text
/// `seed` determines the draws. Returns nothing without participants.
std::optional<difference_test> test_difference(std::span<const difference_counts> people,
                                               std::string_view seed);

/// Tests d' = 0 of the triangular model in the same way. In each simulated study every answer is right with a
/// chance of a third.
std::optional<difference_test> test_oddity(std::span<const right_count> people, std::string_view seed);

/// Returns the exponent of Stevens's power law: the slope of log estimates over log values by least squares.
/// Dividing by the participant's geometric mean does not change it. Returns nothing if fewer than two values
/// differ, or a number is not above 0. Both spans have the same length.
std::optional<double> stevens_exponent(std::span<const double> values, std::span<const double> estimates);

} // namespace tactor::study
