// SPDX-License-Identifier: MIT
/// \file
/// The results of a study as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "study/analysis/analysis.hpp"

namespace tactor::study {

/// Returns an object with the schema tactor-analysis/1.
nlohmann::ordered_json make_analysis_json(const analysis& a);

} // namespace tactor::study
