// SPDX-License-Identifier: MIT
/// \file
/// Functions that draw the trials of a run, in no particular order.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "study/data/definition.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

/// Draws n trials: each cell equally often. If n is not a multiple of the number of cells, the remaining
/// trials have different cells. The n trials include catch trials, if any.
std::vector<planned_trial> draw_cells(const run_definition& r, std::vector<planned_trial> cells,
                                      std::size_t n, random_numbers& numbers);

/// Draws the trials of a run with fewer trials than cells. Motions take turns, and so do the methods of each
/// motion.
std::vector<planned_trial> draw_by_turns(const experiment_definition& d, const run_definition& r,
                                         std::vector<planned_trial> cells, random_numbers& numbers);

/// Function that lists the conditions of a motion: trials that differ in their methods.
using condition_list =
    std::function<std::vector<planned_trial>(std::size_t motion, const std::vector<std::size_t>& methods)>;

/// Lists a trial for each motion and condition, with pairs in both orders.
std::vector<planned_trial> cross_motions(const run_definition& r, const condition_list& conditions);

/// Draws n trials: each cell equally often. If n is not a multiple of the number of cells, the remaining
/// trials have different cells. These trials balance the motions, the conditions, the conditions of each
/// motion, and the orders of each pair, as far as n allows.
std::vector<planned_trial> draw_balanced_trials(const run_definition& r, const condition_list& conditions,
                                                std::size_t n, random_numbers& numbers);

/// Lists a trial for each method.
std::vector<planned_trial> list_methods(std::size_t motion, const std::vector<std::size_t>& methods);

} // namespace tactor::study
