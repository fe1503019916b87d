// SPDX-License-Identifier: MIT
/// \file
/// Comparisons of the figures that a task measures between methods and between sessions, within participants.
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

/// A factor whose levels are compared by each figure of a run.
struct compared_factor {
    std::string name; ///< method or session
    std::vector<level> levels = {};
    std::vector<named_value> figures = {}; ///< without values
    /// Returns a participant's figures in some trials.
    std::function<std::vector<named_value>(const std::vector<trial>&)> measure = {};
};

/// Lists the factors of a run: its methods, if there are several and a trial has one, and the sessions with
/// trials. The figure of cells is their mean. The lists refer to `run`.
std::vector<compared_factor> list_factors(const run_outline& run, const run_people& people, sigmoid kind);

/// Returns the factor whose levels are compared between groups, too: the methods if a trial has one, else a
/// level with all trials, with the main figure. Returns nothing if groups are not compared.
std::optional<compared_factor> find_group_factor(const run_outline& run, sigmoid kind);

/// The figure of the participants who have it at each level.
struct level_values {
    std::vector<std::vector<double>> rows = {}; ///< of all levels, by participant
    std::vector<std::string> groups = {};       ///< by participant
};

/// Compares the groups, and the levels if there are several: group, the factor, and both together.
effect_list compare_with_groups(const std::string& factor, std::size_t levels, const level_values& v);

/// Returns a participant's values of each figure at all levels; nothing if one is missing.
std::vector<std::optional<std::vector<double>>> measure_levels(const compared_factor& f,
                                                               const std::vector<trial>& trials);

/// Adds a comparison of each figure between the levels of each factor. Leaves out participants who lack the
/// figure at a level.
void add_comparisons(std::vector<result>& results, const run_outline& run, const run_people& people,
                     sigmoid kind);

} // namespace tactor::study
