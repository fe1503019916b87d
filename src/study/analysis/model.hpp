// SPDX-License-Identifier: MIT
/// \file
/// Mixed models of a run's trials for R's package lme4.
#pragma once

#include <string>

#include "study/data/dataset.hpp"

namespace tactor::study {

/// Family for answers that choose one of two.
inline constexpr const char* probit = "family = binomial(\"probit\"), ";

/// Parts of a model that depend on the task.
struct r_model {
    std::string response;    ///< "lmer(rating"
    std::string family = {}; ///< "family = binomial, "
    std::string first = {};  ///< a term before the people: "order + "
    std::string slope = {};  ///< the variable of interest: a value, or the presence of a signal
    bool by_method = true;   ///< true if a trial has one method
};

/// Returns the model. Motion, group and method are factors if there are several. Each participant has a slope
/// for the variable of interest: without it, a difference between participants would look like a common
/// effect. Stimuli have no random effects.
std::string write_model(const run_outline& run, bool grouped, const r_model& m);

/// Returns motion, group or both as a term; "1" for neither.
std::string list_factors(const run_outline& run, bool grouped);

/// Returns the term for the values of a run minus the standard or the middle value, so that effects of
/// methods and groups refer to that value. Empty if nothing varies.
std::string write_value(const run_outline& run);

/// Returns a text in the quotes of R.
std::string quote(const std::string& text);

} // namespace tactor::study
