// SPDX-License-Identifier: MIT
/// \file
/// Psychometric functions by maximum likelihood, with intervals by a parametric bootstrap.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "study/statistics/quest.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

enum class sigmoid { normal, logistic };

/// The answers to one stimulus: k of n were "yes", "more" or right; 0 <= k <= n.
struct answer_block {
    double x; ///< any unit
    std::size_t n;
    std::size_t k;
};

/// The family that a fit chooses from: F(x) = guess + (1 - guess - lapse) S((x - threshold) / slope).
struct psychometric_family {
    sigmoid kind = sigmoid::normal; ///< S: Phi(z) or 1 / (1 + exp(-z))
    double guess = 0.0;             ///< 0 to below 1 - most_lapse, fixed
    double most_lapse = 0.06;       ///< the lapse is fitted within 0 and this; 0: none
};

/// Returns F(x).
double chance(double x, const psychometric& p, const psychometric_family& f);

struct psychometric_fit {
    psychometric parameters = {};
    bool step = false; ///< answers rise in one step: the threshold lies somewhere in it, the slope is too
                       ///< steep to be known, and the jnd is missing
    std::optional<double> pse = {}; ///< x where F is 0.5; none where F does not reach it, or with a guess
    std::optional<double> jnd = {}; ///< half the distance of the x where F is 0.25 and 0.75; as the pse
    double deviance = 0.0;          ///< against a free chance for each block
};

/// Fits a family to answers by maximum likelihood. Nothing where answers are flat or fall. Blocks of one x
/// are best joined: the deviance needs many trials in each. With lapses or a guess the likelihood may have
/// several maxima: the search begins at slopes no steeper than the spacing of the stimuli.
std::optional<psychometric_fit> fit_psychometric(std::span<const answer_block> blocks,
                                                 const psychometric_family& f);

/// Intervals (95 %) and goodness of fit by simulated answers. With 7 values 1 apart, 20 or 40 trials each,
/// slopes of 0.6 to 2.5 and lapses of 0 to 0.05, intervals of 1,000 simulated people held the pse in 93 to 97
/// %, the threshold and the jnd in 92 to 97 %.
struct psychometric_bootstrap {
    std::optional<interval> threshold = {}; ///< percentiles
    std::optional<interval> pse = {};       ///< percentiles
    std::optional<interval> jnd = {}; ///< percentiles corrected for bias (Efron 1987): fits are too steep
    std::optional<double> p_gof = {}; ///< (1 + deviances at least as large) / (1 + all)
    std::size_t failed = 0;           ///< simulated sets of answers that are flat or fall
};

/// Simulates `times` sets of answers from a fit to these blocks, and fits the family to each; a set that
/// rises in one step counts with its steep slope. The text `seed` determines the draws. Shallow functions and
/// few trials give many sets that have no fit: with more than 5 % of these intervals and p are missing, as
/// they are for a fit that is a step.
psychometric_bootstrap bootstrap_psychometric(std::span<const answer_block> blocks,
                                              const psychometric_family& f, const psychometric_fit& fit,
                                              std::string_view seed, std::size_t times = 2000);

} // namespace tactor::study
