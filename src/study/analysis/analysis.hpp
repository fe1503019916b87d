// SPDX-License-Identifier: MIT
/// \file
/// The analysis of a study, run by run.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/bids/dataset.hpp"
#include "study/results/model.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

/// Returns true if two or more groups do the whole run, so that groups can be compared. If a group does only
/// a part of the run, the effect of the group cannot be separated from the effect of the missing part.
bool can_compare_groups(const run_outline& run, const std::vector<group_outline>& groups);

/// Lists the sessions with trials of a run.
std::set<session_number> list_played_sessions(const dataset& d, std::size_t run);

/// Returns the factors of a run's model: the group if groups can be compared, and the session if several
/// sessions have trials of the run.
model_factors find_model_factors(const dataset& d, std::size_t run);

/// Analyses a study. `kind`: shape of the psychometric functions.
analysis analyse(const dataset& d, sigmoid kind = sigmoid::normal);

/// Returns the name of the results of a group in a run.
std::string format_result_name(std::string_view run, std::string_view group);

} // namespace tactor::study
