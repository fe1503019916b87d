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

/// A family of functions from which a fit chooses:
/// F(x) = guess + lapses_to_yes lapse + (1 - guess - lapse) S((x - threshold) / slope).
struct psychometric_family {
    sigmoid kind = sigmoid::normal; ///< S: Phi(z) or 1 / (1 + exp(-z))
    double guess = 0.0;             ///< 0 to below 1 - most_lapse, fixed
    double most_lapse = 0.06;       ///< upper bound of the fitted lapse; 0: no lapses
    double lapses_to_yes = 0.0;     ///< part of the lapses that end in "yes"
};

/// Returns the family for two answers of equal rank: in a lapse, either key is pressed.
constexpr psychometric_family two_answers(sigmoid kind) noexcept
{
    return {kind, 0.0, 0.12, 0.5};
}

/// Returns the family of right answers to two intervals: a guess is right in half of the trials.
constexpr psychometric_family right_answers(sigmoid kind) noexcept
{
    return {.kind = kind, .guess = 0.5};
}

/// Returns F(x).
double chance(double x, const psychometric& p, const psychometric_family& f);

struct psychometric_fit {
    psychometric parameters = {};
    bool step = false; ///< answers rise in one step: the threshold lies somewhere in it, and the slope is too
                       ///< steep to be known
    double deviance = 0.0; ///< against a free chance for each block
};

/// Returns the z at which S is 0.75: the jnd is the slope times this.
double find_quartile(sigmoid kind) noexcept;

/// Fits a family to answers by maximum likelihood. Returns nothing if the answers are flat or fall. Join
/// blocks with the same x first: the deviance needs many trials in each block. With lapses or a guess the
/// likelihood may have several maxima: the search begins at slopes no steeper than the spacing of the
/// stimuli.
std::optional<psychometric_fit> fit_psychometric(std::span<const answer_block> blocks,
                                                 const psychometric_family& f);

/// Intervals (95 %) and goodness of fit from simulated answers. tests/study/test_observers.cpp measures how
/// often the intervals contain the true value.
struct psychometric_bootstrap {
    std::optional<interval> threshold = {}; ///< percentiles
    std::optional<interval> slope = {}; ///< percentiles corrected for bias (Efron 1987): fits are too steep
    std::optional<double> p_gof = {};   ///< (1 + deviances at least as large) / (1 + all)
    std::size_t failed = 0;             ///< simulated sets of answers that are flat or fall
};

/// Simulates `times` sets of answers from a fit to these blocks, and fits the family to each. A set that
/// rises in one step counts with its steep slope. The text `seed` determines the draws. Shallow functions and
/// few trials give many sets without a fit. If more than 5 % have none, or the fit itself is a step,
/// intervals and p are missing.
psychometric_bootstrap bootstrap_psychometric(std::span<const answer_block> blocks,
                                              const psychometric_family& f, const psychometric_fit& fit,
                                              std::string_view seed, std::size_t times = 2000);

} // namespace tactor::study
