// SPDX-License-Identifier: MIT
/// \file
/// Results of a task in which each trial gives a value for a cell. A cell is a motion with one method, or
/// with the two methods that are compared.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/results/result.hpp"

namespace tactor::study {

/// Values by row and motion. Each row is a method; a choice between two methods has only one row.
using cell_values = std::vector<std::vector<double>>;

/// Cells of a run, with the function that computes values from trials.
struct cell_plan {
    std::vector<std::string> methods = {}; ///< methods of the rows
    /// Lists the rows to which a trial contributes, each with the trial's value.
    std::function<std::vector<std::pair<std::size_t, double>>(const trial&)> score = {};
    interval possible = per_cents;
    std::optional<double> against = {}; ///< value expected from guessing; if missing, means are not tested
    std::string axis = {};
    /// Name of a participant's mean over cells, by which methods and sessions are compared. Empty if they are
    /// not compared.
    std::string figure = {};

    /// Returns the greatest difference that rounding errors can make between equal values.
    double rounding() const noexcept { return few_digits * possible.second; }
};

/// Returns a participant's values; nothing if a cell has no trial.
std::optional<cell_values> compute_cells(const run_outline& run, const cell_plan& plan,
                                         const std::vector<trial>& trials);

/// Lists the values of cells, with METHOD and MOTION as names. If a cell has no trial, lists only names.
std::vector<named_value> list_cell_values(const run_outline& run, const cell_plan& plan,
                                          const std::vector<trial>& trials);

/// Returns the values of all participants. \pre Each participant has a trial in each cell.
std::vector<cell_values> compute_all_cells(const run_outline& run, const cell_plan& plan,
                                           const run_people& people);

/// Tests the means of each row.
std::vector<cell_means> test_cells(const run_outline& run, const cell_plan& plan,
                                   const std::vector<cell_values>& all);

/// Computes the effect of the motion. If `methods`, also computes the effects of the method and of the
/// interaction.
effect_list list_effects(const run_outline& run, const std::vector<cell_values>& all, bool methods);

/// Compares the motions of a row by Tukey's test.
tukey_list compare_by_tukey(const std::vector<cell_values>& all, std::size_t row, const cell_means& means);

/// Compares the motions of a row by paired t tests.
paired_list compare_in_pairs(const cell_means& means, double rounding);

/// Compares groups of participants by all cells. `groups`: group of each participant. Effects are missing if
/// there is only one group.
mixed_anova compare_groups(const std::vector<cell_values>& all, const std::vector<std::string>& groups);

/// Adds the mixed analysis of variance of groups, if groups are compared. `all`: cells of `people`.
void add_groups(std::vector<result>& results, const run_outline& run, const run_people& people,
                const std::vector<cell_values>& all, bool methods);

/// Adds the same analysis for one value per participant. Skips participants without a value.
void add_groups(std::vector<result>& results, const run_people& people,
                const std::vector<std::optional<double>>& values);

} // namespace tactor::study
