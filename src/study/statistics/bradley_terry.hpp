// SPDX-License-Identifier: MIT
/// \file
/// Worths of items that were compared in pairs.
#pragma once

#include <optional>
#include <vector>

namespace tactor::study {

/// The worth of one of several items, relative to the first of them.
struct worth {
    std::optional<double> log_worth = {}; ///< natural logarithm; 0 for the first; none: not finite
    std::optional<double> se = {};        ///< standard error; 0 for the first, which is fixed
};

/// Estimates the worths w of one item or more by maximum likelihood. Item a is preferred to item b with the
/// probability w_a / (w_a + w_b) (Bradley and Terry 1952). `wins[a][b]` counts how often a was preferred to
/// b, 0 or more; the diagonal is not used. Standard errors come from the information matrix, which assumes
/// independent comparisons. A worth is finite if a chain of preferences leads from its item to the first, and
/// one leads back (Ford 1957).
std::vector<worth> bradley_terry(const std::vector<std::vector<double>>& wins);

} // namespace tactor::study
