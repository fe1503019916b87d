// SPDX-License-Identifier: MIT
/// \file
/// Results of a task that measures: of a participant a psychometric function, d', or the exponent of
/// magnitude estimates.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/data/dataset.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/statistics/signal_detection.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

/// Sensitivity with the rates that it is from, corrected: corrected_rate().
struct detection {
    double hits = 0.0;
    double false_alarms = 0.0;
    sensitivity found = {};
    difference_counts counts = {}; ///< of the answers; detect: to a stimulus and to none
};

/// Estimates of one value.
struct value_estimate {
    double value = 0.0;
    double ratio = 1.0; ///< of the geometric mean of its estimates to that of all values
    std::size_t n = 0;  ///< estimates
};

/// Results of a participant, those that the run's task has.
struct person_measures {
    std::vector<answer_block> blocks = {}; ///< answers by value, ascending
    double guess = 0.0;                    ///< detect: share of catch trials with a yes
    std::optional<psychometric_fit> fit = {};
    psychometric_bootstrap bootstrap = {};
    std::optional<double> pse = {}; ///< constant, adaptive: the threshold of the fit
    std::optional<double> jnd = {}; ///< the same; none where the answers rise in one step
    std::optional<interval> jnd_ci = {};
    std::optional<detection> detected = {};
    std::optional<double> exponent = {};
    std::vector<value_estimate> estimates = {}; ///< by value, ascending; empty without an exponent
};

/// Returns the family of a run's psychometric functions; `guess`: share of catch trials with a yes.
psychometric_family find_family(const run_outline& run, sigmoid kind, double guess) noexcept;

/// Measures trials of a participant. The bootstrap draws from `seed`; empty: there is none.
person_measures measure_trials(const run_outline& run, const std::vector<trial>& trials, sigmoid kind,
                               std::string_view seed);

/// A figure of the results, by its name in them.
using named_measure = std::pair<std::string_view, std::optional<double>>;

/// Lists the figures of a participant, the main one first: pse and jnd; threshold; dprime and c; exponent.
std::vector<named_measure> list_measures(const run_outline& run, const person_measures& m);

/// Returns the value against which the main figure is tested: the standard, 0 or 1; nothing without one.
std::optional<double> measured_against(const run_outline& run) noexcept;

/// Returns the ratio of the sizes of two values: of the amplitudes, if they are levels in dB.
double size_ratio(const run_outline& run, double value, double to) noexcept;

/// Results of a run's trials in one condition, or in all of them.
struct measured_condition {
    std::string name = {};                                         ///< METHOD:MOTION; empty: all trials
    std::vector<person_measures> people = {};                      ///< by participant
    std::vector<std::pair<std::string_view, t_test>> figures = {}; ///< over participants, as list_measures()
    std::optional<difference_test> difference = {}; ///< same-different: in place of t and p of d'
};

/// A participant's trials that count.
struct person_trials {
    std::string code;
    const std::vector<trial>* trials = nullptr;
};

/// Measures all trials, and then each condition, if there are several.
std::vector<measured_condition> measure_run(const run_outline& run, const std::vector<person_trials>& people,
                                            sigmoid kind);

} // namespace tactor::study
