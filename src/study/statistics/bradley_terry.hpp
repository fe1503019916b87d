// SPDX-License-Identifier: MIT
/// \file
/// Worths of items that were compared in pairs.
#pragma once

#include <optional>
#include <vector>

namespace tactor::study {

/// The worth of an item, relative to the first item.
struct worth {
    std::optional<double> log_worth = {}; ///< natural logarithm; 0 for the first item; missing if not finite
    std::optional<double> se = {};        ///< standard error; 0 for the first item, whose worth is fixed
};

/// Estimates the worths w of one or more items by maximum likelihood. Item a is preferred to item b with the
/// probability w_a / (w_a + w_b) (Bradley and Terry 1952). `wins[a][b]` counts how often a was preferred to
/// b, 0 or more; the diagonal is not used. Standard errors come from the information matrix, which assumes
/// independent comparisons. The worth of an item is finite if chains of preferences lead from this item to
/// the first item and back (Ford 1957).
std::vector<worth> fit_bradley_terry(const std::vector<std::vector<double>>& wins);

} // namespace tactor::study
