// SPDX-License-Identifier: MIT
/// \file
/// The texts of the files that describe a study. Each says so where nobody was asked.
#pragma once

#include <optional>
#include <string>

#include "study/experiment/definition.hpp"

namespace tactor::study {

/// dataset_description.json
std::string dataset_text(const experiment_definition& d, bool simulated);
/// What a dataset_description.json says of that; nothing where tactor experiment did not write it.
std::optional<bool> says_simulated(const std::string& dataset_description);
/// README
std::string readme_text(const experiment_definition& d, bool simulated);
/// participants.json
std::string participants_text(bool simulated);
/// task-NAME_beh.json
std::string task_text(const run_definition& r, bool simulated);

} // namespace tactor::study
