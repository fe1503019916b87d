// SPDX-License-Identifier: MIT
/// \file
/// Mixed models of a run's trials for R's package lme4.
#pragma once

#include <string>

#include "study/data/outline.hpp"

namespace tactor::study {

/// Family for answers that choose one of two.
inline constexpr const char* probit = "family = binomial(\"probit\"), ";

/// Term of the sessions. The table has session numbers, which the model must treat as names.
inline constexpr const char* session_factor = "factor(session)";

/// Factors that a model has only if groups can be compared, or if several sessions have trials.
struct model_factors {
    bool group = false;
    bool session = false;
};

/// Parts of a model that depend on the task.
struct r_model {
    std::string response;    ///< start of the call, such as "lmer(rating"
    std::string family = {}; ///< argument `family`, such as "family = binomial, "
    std::string first = {};  ///< term before the random effects, such as "order + "
    std::string slope = {};  ///< variable of interest: a value, or the presence of a signal
    bool by_method = true;   ///< true if a trial has one method
};

/// Returns the call that fits the model. Motion, group, session and method are factors if there are several
/// of each. Participants have random slopes for the variable of interest, for the method (or else the motion)
/// and for the session: without such a slope, a difference between participants would look like a common
/// effect. Stimuli have no random effects.
std::string format_model_call(const run_outline& run, const model_factors& f, const r_model& m);

/// Returns the call that fits the model of a run in which some trials have no stimulus. Method and motion
/// only change the effect of a signal, because a trial without a stimulus has neither. Group and session also
/// change the criterion. So the coefficient of signal is d', over all methods.
std::string format_signal_call(const run_outline& run, const model_factors& f);

/// Returns one term that crosses group, motion and session. Leaves out factors with only one level; returns
/// "1" if none remains.
std::string list_factors(const run_outline& run, const model_factors& f);

/// Returns the term for the values of a run. Subtracts the standard, or else the middle value, so that
/// effects of methods and groups refer to this value. Empty if the run varies nothing.
std::string format_value_term(const run_outline& run);

/// Returns a text as a quoted string of R.
std::string quote(const std::string& text);

} // namespace tactor::study
