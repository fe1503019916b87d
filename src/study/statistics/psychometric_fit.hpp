// SPDX-License-Identifier: MIT
/// \file
/// Fits of psychometric functions by maximum likelihood, with intervals from a parametric bootstrap.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "study/statistics/quest.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

enum class sigmoid { normal, logistic };

/// The answers to one stimulus: k of n answers were "yes", "more" or right; 0 <= k <= n.
struct answer_block {
    double x; ///< stimulus, in any unit
    std::size_t n;
    std::size_t k;
};

/// A family of functions from which a fit chooses:
/// F(x) = guess + lapses_to_yes lapse + (1 - guess - lapse) S((x - threshold) / slope).
struct psychometric_family {
    sigmoid kind = sigmoid::normal; ///< S: Phi(z) or 1 / (1 + exp(-z))
    double guess = 0.0;             ///< guess rate, fixed; 0 to below 1 - most_lapse
    double most_lapse = 0.06;       ///< upper bound of the fitted lapse; 0 for a fit without lapses
    double lapses_to_yes = 0.0;     ///< share of the lapses in which the answer is "yes"
};

/// Returns the family for two answers of equal rank: in a lapse, both answers are equally likely.
constexpr psychometric_family two_answer_family(sigmoid kind) noexcept
{
    return {kind, 0.0, 0.12, 0.5};
}

/// Returns the family for right answers in trials with two intervals: half of the guesses are right.
constexpr psychometric_family right_answers(sigmoid kind) noexcept
{
    return {.kind = kind, .guess = 0.5};
}

/// Returns F(x).
double chance(double x, const psychometric& p, const psychometric_family& f);

struct psychometric_fit {
    psychometric parameters = {};
    /// True if the answers rise in one step. The threshold lies somewhere in this step, and the slope is too
    /// steep to be estimated.
    bool step = false;
    double deviance = 0.0; ///< deviance from the model with a separate chance for each block
};

/// Returns the z at which S is 0.75. The just noticeable difference is this z times the slope.
double find_quartile(sigmoid kind) noexcept;

/// Fits a family to answers by maximum likelihood. Returns nothing if the share k / n does not rise with x.
/// Join blocks with the same x before the fit, because the deviance needs many trials in each block. With
/// lapses or a guess the likelihood may have several maxima. The search starts from slopes that are no
/// steeper than the spacing of the stimuli.
std::optional<psychometric_fit> fit_psychometric(std::span<const answer_block> blocks,
                                                 const psychometric_family& f);

/// Intervals (95 %) and goodness of fit from simulated answers. tests/study/test_observers.cpp measures how
/// often the intervals contain the true value.
struct psychometric_bootstrap {
    std::optional<interval> threshold = {}; ///< percentiles
    /// Percentiles, corrected for bias (Efron 1987), because fits are too steep.
    std::optional<interval> slope = {};
    std::optional<double> p_gof = {}; ///< (1 + number of deviances >= the fit's) / (1 + all)
    std::size_t failed = 0;           ///< number of simulated sets of answers without a fit
};

/// Simulates `times` sets of answers from a fit to these blocks, and fits the family to each set. If the
/// answers of a set rise in one step, the set counts with a steep slope. The text `seed` determines the
/// random numbers. Intervals and p are missing if `fit` is a step, or if more than 5 % of the sets have no
/// fit, which is likely for shallow functions and few trials.
psychometric_bootstrap bootstrap_psychometric(std::span<const answer_block> blocks,
                                              const psychometric_family& f, const psychometric_fit& fit,
                                              std::string_view seed, std::size_t times = 2000);

} // namespace tactor::study
