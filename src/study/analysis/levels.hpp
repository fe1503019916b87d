// SPDX-License-Identifier: MIT
/// \file
/// Comparisons of the figures that a task measures between methods and between sessions, within participants.
#pragma once

#include <vector>

#include "study/results/result.hpp"

namespace tactor::study {

/// Adds a comparison of each figure between the run's methods, if there are several and a trial has one, and
/// between the sessions with trials. The figure of cells is their mean. Leaves out participants who lack the
/// figure at a level.
void add_comparisons(std::vector<result>& results, const run_outline& run, const run_people& people,
                     sigmoid kind);

} // namespace tactor::study
