// SPDX-License-Identifier: MIT
/// \file
/// The results of a study as JSON.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "study/results/result.hpp"

namespace tactor::study {

/// Returns an object with the schema tactor-analysis/1.
nlohmann::ordered_json make_analysis_json(const analysis& a);

/// Returns the JSON schema of tactor-analysis/1.
nlohmann::ordered_json analysis_schema();

// These functions return parts of the object with the schema tactor-analysis/1.
nlohmann::ordered_json value_json(const result_value& v);

} // namespace tactor::study
