// SPDX-License-Identifier: MIT
/// \file
/// Random orders of trials in which no motion comes too often in a row.
#pragma once

#include <cstddef>
#include <span>

#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

/// Returns true if the trials can be ordered so that no motion comes more than `most` times in a row.
bool has_order(std::span<const planned_trial> trials, std::size_t most);

/// Puts trials into a random order in which no motion comes more than `most` times in a row.
/// \pre has_order(trials, most)
void order_trials(std::span<planned_trial> trials, std::size_t most, random_numbers& numbers);

} // namespace tactor::study
