// SPDX-License-Identifier: MIT
/// \file
/// The results of a study: means, tests and effect sizes, run by run, as values.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/analysis/measures.hpp"
#include "study/data/dataset.hpp"
#include "study/statistics/bradley_terry.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

/// A measure for each motion; "all" is about the participants' unweighted means over motions.
struct by_motion {
    t_test all = {};
    std::vector<t_test> motion = {};
    std::vector<double> all_values = {};                 ///< of each participant
    std::vector<std::vector<double>> motion_values = {}; ///< the same, by motion
    std::vector<std::optional<double>> p_holm = {};      ///< of the motions' p
};

/// Response times: the median of the participants' medians, each of the times that were recorded. Nothing
/// where there is none.
struct response_times {
    std::optional<double> median_s = {}; ///< of all trials
    /// The same for each condition: MOTION, or METHOD:MOTION where a trial has one stimulus.
    std::vector<std::pair<std::string, std::optional<double>>> by = {};
};

struct run_analysis {
    run_outline run;
    std::size_t n = 0;                  ///< participants with a trial that counts in each cell
    std::vector<left_out> missing = {}; ///< have trials that are not in the figures
    std::size_t trials = 0;             ///< that count, of the n
    std::size_t voids = 0;              ///< of everybody who was selected
    std::size_t early = 0;              ///< answers marked early, of the same; they count
    response_times times = {};          ///< of the n
    /// Group of the participants, whose name is in that of `run`, too. Empty: those whose group has all of
    /// it.
    std::string group = {};
    std::string whole = {}; ///< name of the run without the group

    /// choose: per cent of trials in which the last method was chosen, against 50; of three methods or more
    /// by method: per cent of the trials with the method in which it was chosen, against 50.
    /// rate: mean ratings by method, not tested. identify: per cent correct by method, against chance.
    std::vector<by_motion> cells = {};
    /// choose: per cent of trials in which the first interval was chosen, against 50.
    t_test first_interval = {};
    /// choose among three methods or more: by method, from the trials of all n.
    std::vector<worth> worths = {};
    /// rate, two methods or more: the last less the first, over all motions, against 0.
    t_test paired = {};
    /// choose between two methods: `second` is of motions. rate: `first` of methods, `second` of motions.
    anova effects = {};
    /// Groups that have all of the run, compared, in a task that measures by the main figure of all trials;
    /// choose among three methods or more has none. Without figures where fewer than two groups have
    /// participants.
    std::optional<mixed_anova> groups_compared = {};
    /// Pairs of motions: choose between two methods: one list. rate: one for each method, from that method's
    /// own one-way analysis.
    std::vector<std::vector<comparison>> pairs = {};
    /// identify: pairs of motions by method, participants' per cents correct against each other.
    std::vector<std::vector<paired_comparison>> paired_motions = {};
    /// Tasks that measure: all trials, then each condition, if there are several.
    std::vector<measured_condition> measures = {};
    std::vector<std::string> codes = {}; ///< of the participants in them
    sigmoid function = sigmoid::normal;  ///< of their psychometric functions
    /// identify: answers by method, motion and motion answered, all participants.
    std::vector<std::vector<std::vector<std::size_t>>> confusion = {};
};

struct analysis {
    std::string experiment; ///< its name
    std::size_t participants = 0;
    bool simulated = false;
    std::vector<left_out> excluded = {}; ///< by whoever asked for the analysis
    /// Results of everybody, then of each group those of the runs that it has.
    std::vector<run_analysis> runs = {};
    std::vector<std::string> warnings = {};   ///< about files and participants
    std::vector<std::string> no_figures = {}; ///< why figures are missing
};

/// Returns the per cent that guessing gives.
double chance(const run_outline& run) noexcept;

/// Tests whether a run chooses among three methods or more: each has a row of cells and a worth.
bool has_worths(const run_outline& run) noexcept;

/// Tests whether two groups or more have all of a run: of others the group cannot be told from what it lacks.
bool has_groups(const run_outline& run, const std::vector<group_outline>& groups);

/// Returns the effects of `groups_compared` by name, as "group:motion"; null where a factor has one level.
std::vector<std::pair<const char*, const effect*>> list_group_effects(const run_analysis& r);

/// `kind`: of the psychometric functions.
analysis analyse(const dataset& d, sigmoid kind = sigmoid::normal);

/// Returns the name of the results of a group in a run.
std::string name_result(std::string_view run, std::string_view group);

/// Values by row (method; one row for choose between two) and motion.
using cell_values = std::vector<std::vector<double>>;

/// Returns a participant's values in a run: choose: per cent in which the last method was chosen, or each of
/// three methods or more in its trials; rate: the mean rating; identify: per cent correct. Nothing if a cell
/// has no trial.
std::optional<cell_values> compute_cells(const run_outline& run, const std::vector<trial>& trials);

/// Returns the methods of these rows: of choose the last one.
std::vector<std::string> row_methods(const run_outline& run);

/// Returns the largest difference of a run's values that rounding may leave of 0.
double rounding_in(const run_outline& run) noexcept;

/// Returns a participant's value in the main comparison of a run. choose: per cent in which the last method
/// was chosen (in its trials), against 50; rate: the last method's mean less the first's, against 0, nothing
/// for one method; identify: per cent correct by the last method, against chance. Sets to 0 what rounding
/// leaves of 0.
std::optional<double> compared_value(const run_outline& run, const cell_values& cells);

/// Returns the method with which a trial of choose was answered: its place in the run's.
std::size_t chosen_method(const trial& t) noexcept;

/// Limits of a mean of per cents, and of a run's values: per cents or ratings.
inline constexpr interval per_cents{0.0, 100.0};
interval possible_values(const run_outline& run);

/// Cuts an interval from t, which knows no bounds of the values, to what is possible.
interval cut_to(const interval& i, const interval& possible);

} // namespace tactor::study
