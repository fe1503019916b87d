// SPDX-License-Identifier: MIT
/// \file
/// Mixed models of a run's trials for R's package lme4.
#pragma once

#include <string>

#include "study/data/dataset.hpp"

namespace tactor::study {

/// Family of answers that say which of two is more.
inline constexpr const char* probit = "family = binomial(\"probit\"), ";

/// Parts of a model that depend on the task.
struct r_model {
    std::string response;    ///< "lmer(rating"
    std::string family = {}; ///< "family = binomial, "
    std::string first = {};  ///< a term before the people: "order + "
    std::string slope = {};  ///< what the run is about: a value, or whether there was a signal
    bool by_method = true;   ///< a trial has one method
};

/// Returns the model. Motion and group are factors, and method, where there are several. People differ in
/// what is asked about, too: without its slope for each of them, such a difference passes for an effect of
/// all. Nothing of the stimuli is taken to be a sample.
std::string write_model(const run_outline& run, bool grouped, const r_model& m);

/// Returns motion, group or both as a term; "1" for neither.
std::string list_factors(const run_outline& run, bool grouped);

/// Returns the values of a run less the standard, or the middle of them: effects of methods and groups are
/// those there. Empty where nothing varies.
std::string write_value(const run_outline& run);

/// Returns a text as R reads it.
std::string quote(const std::string& text);

} // namespace tactor::study
