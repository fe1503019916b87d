// SPDX-License-Identifier: MIT
/// \file
/// Random orders of trials in which no motion comes too often in a row.
#pragma once

#include <cstddef>
#include <span>

#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

/// Returns true if trials have an order in which no motion comes more often in a row than `most`.
bool has_order(std::span<const planned_trial> trials, std::size_t most);

/// Puts trials into a random order in which no motion comes more often in a row than `most`.
/// \pre has_order(trials, most)
void order_trials(std::span<planned_trial> trials, std::size_t most, random_numbers& numbers);

} // namespace tactor::study
