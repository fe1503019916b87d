// SPDX-License-Identifier: MIT
/// \file
/// Mixed models of a run's trials for R's package lme4.
#pragma once

#include <string>

#include "study/data/outline.hpp"

namespace tactor::study {

/// Family for answers that choose one of two.
inline constexpr const char* probit = "family = binomial(\"probit\"), ";

/// Term of the sessions. The table has their numbers.
inline constexpr const char* session_factor = "factor(session)";

/// Factors that a model has because the study has several of them.
struct model_factors {
    bool group = false;
    bool session = false;
};

/// Parts of a model that depend on the task.
struct r_model {
    std::string response;    ///< "lmer(rating"
    std::string family = {}; ///< "family = binomial, "
    std::string first = {};  ///< a term before the people: "order + "
    std::string slope = {};  ///< the variable of interest: a value, or the presence of a signal
    bool by_method = true;   ///< true if a trial has one method
};

/// Returns the model. Motion, group, session and method are factors if there are several. Each participant
/// has a slope for the variable of interest and for sessions: without it, a difference between participants
/// would look like a common effect. Stimuli have no random effects.
std::string write_model(const run_outline& run, const model_factors& f, const r_model& m);

/// Returns group, motion and session, as far as there are several, as one term; "1" for none.
std::string list_factors(const run_outline& run, const model_factors& f);

/// Returns the term for the values of a run minus the standard or the middle value, so that effects of
/// methods and groups refer to that value. Empty if nothing varies.
std::string write_value(const run_outline& run);

/// Returns a text in the quotes of R.
std::string quote(const std::string& text);

} // namespace tactor::study
