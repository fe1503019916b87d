// SPDX-License-Identifier: MIT
/// \file
/// The analysis of a study, run by run, as values.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/results/result.hpp"

namespace tactor::study {

/// Tests whether two groups or more have all of a run: of others the group cannot be told from what it lacks.
bool has_groups(const run_outline& run, const std::vector<group_outline>& groups);

/// `kind`: of the psychometric functions.
analysis analyse(const dataset& d, sigmoid kind = sigmoid::normal);

/// Returns the name of the results of a group in a run.
std::string name_result(std::string_view run, std::string_view group);

} // namespace tactor::study
