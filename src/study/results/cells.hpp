// SPDX-License-Identifier: MIT
/// \file
/// Results of a task in which each trial is a value of a cell: a motion with one method, or with both.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/results/result.hpp"

namespace tactor::study {

/// Values by row (method; one row for choose between two) and motion.
using cell_values = std::vector<std::vector<double>>;

/// Cells of a run, with the function that computes values from trials.
struct cell_plan {
    std::vector<std::string> methods = {}; ///< methods of the rows
    /// Lists the rows that a trial is in, each with its value.
    std::function<std::vector<std::pair<std::size_t, double>>(const trial&)> score = {};
    interval possible = per_cents;
    std::optional<double> against = {}; ///< value expected from guessing; if missing, means are not tested
    std::string axis = {};
    /// Name of a participant's mean over cells when methods or sessions are compared; empty: they are not.
    std::string figure = {};

    /// Returns the largest difference between equal values that rounding may leave.
    double rounding() const noexcept { return few_digits * possible.second; }
};

/// Returns a participant's values; nothing if a cell has no trial.
std::optional<cell_values> compute_cells(const run_outline& run, const cell_plan& plan,
                                         const std::vector<trial>& trials);

/// Lists the values by METHOD and MOTION. Lists only the names if a cell has no trial.
std::vector<named_value> list_cell_values(const run_outline& run, const cell_plan& plan,
                                          const std::vector<trial>& trials);

/// Returns the values of all participants. \pre Each participant has a trial in each cell.
std::vector<cell_values> compute_all_cells(const run_outline& run, const cell_plan& plan,
                                           const run_people& people);

/// Tests the means of each row.
std::vector<cell_means> test_cells(const run_outline& run, const cell_plan& plan,
                                   const std::vector<cell_values>& all);

/// Computes the effects of motions; if `methods`, also the effects of methods and of both together.
effect_list list_effects(const run_outline& run, const std::vector<cell_values>& all, bool methods);

/// Compares the motions of a row by Tukey's test.
tukey_list compare_by_tukey(const std::vector<cell_values>& all, std::size_t row, const cell_means& means);

/// Compares the motions of a row by paired t tests.
paired_list compare_in_pairs(const cell_means& means, double rounding);

/// Compares the groups of participants by all their cells. Effects are missing with one group.
mixed_anova compare_groups(const std::vector<cell_values>& all, const std::vector<std::string>& groups);

/// Adds the mixed analysis of variance of groups, if groups are compared. `all`: cells of `people`.
void add_groups(std::vector<result>& results, const run_outline& run, const run_people& people,
                const std::vector<cell_values>& all, bool methods);

/// Adds the same analysis of one value per participant, which may be missing.
void add_groups(std::vector<result>& results, const run_people& people,
                const std::vector<std::optional<double>>& values);

} // namespace tactor::study
