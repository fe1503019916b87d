// SPDX-License-Identifier: MIT
/// \file
/// Comparisons within participants of the figures that a task measures: between methods, and between
/// sessions.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/results/result.hpp"

namespace tactor::study {

/// A level of a factor, with the trials that belong to it.
struct level {
    std::string name;
    std::function<bool(const trial&)> has;
};

/// A factor whose levels are compared in each figure of a run.
struct compared_factor {
    std::string name; ///< method or session; empty for a single level
    std::vector<level> levels = {};
    std::vector<named_value> figures = {}; ///< names, without values
    /// Computes a participant's figures from some of the trials.
    std::function<std::vector<named_value>(const std::vector<trial>&)> measure = {};
};

/// Lists the factors of a run: the methods, if there are several and each trial has only one, and the
/// sessions with trials. For a task with cells, the figure is the mean over the cells. The result refers to
/// `run`.
std::vector<compared_factor> list_factors(const run_outline& run, const run_people& people, sigmoid kind);

/// Returns the factor whose levels are also compared between groups: the methods, if each trial has only one,
/// or else a single level with all trials and the main figure. Returns nothing if groups are not compared.
std::optional<compared_factor> find_group_factor(const run_outline& run, sigmoid kind);

/// Values of one figure, for the participants who have a value at each level.
struct level_values {
    std::vector<std::vector<double>> rows = {}; ///< values at all levels, by participant
    std::vector<std::string> groups = {};       ///< group of each participant
};

/// Computes the effects of the group and, if there are several levels, of the factor and of the interaction.
effect_list compute_group_effects(const std::string& factor, std::size_t levels, const level_values& v);

/// Returns a participant's values at all levels, for each figure. A figure's list of values is missing if the
/// figure has no value at one of the levels.
std::vector<std::optional<std::vector<double>>> measure_levels(const compared_factor& f,
                                                               const std::vector<trial>& trials);

/// Adds a comparison of each figure between the levels of each factor. Leaves out participants who lack the
/// figure at a level.
void add_comparisons(std::vector<result>& results, const run_outline& run, const run_people& people,
                     sigmoid kind);

} // namespace tactor::study
