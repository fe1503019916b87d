// SPDX-License-Identifier: MIT
/// \file
/// Trials of a run, drawn in no order.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

/// Draws n trials: each cell equally often, and of the rest different cells. With catch trials, these are a
/// part of the n.
std::vector<planned_trial> draw_cells(const run_definition& r, std::vector<planned_trial> cells,
                                      std::size_t n, random_numbers& numbers);

/// Draws fewer trials than there are cells, so that the motions take turns, and those of each method, too.
std::vector<planned_trial> draw_by_turns(const experiment_definition& d, const run_definition& r,
                                         std::vector<planned_trial> cells, random_numbers& numbers);

/// Lists the conditions of a motion for some methods: trials that differ in the methods.
using condition_list =
    std::function<std::vector<planned_trial>(std::size_t motion, const std::vector<std::size_t>& methods)>;

/// Lists each motion by each condition, pairs in both orders.
std::vector<planned_trial> cross_motions(const run_definition& r, const condition_list& conditions);

/// Draws n trials: each cell equally often, and of the rest, which are different cells, each motion, each
/// method or pair, each of them in a motion, and each order of a pair equally often as far as n allows. The
/// cells of one motion stand together.
std::vector<planned_trial> draw_balanced(const run_definition& r, const condition_list& conditions,
                                         std::size_t n, random_numbers& numbers);

/// Lists a trial for each method.
std::vector<planned_trial> list_methods(std::size_t motion, const std::vector<std::size_t>& methods);

} // namespace tactor::study
