// SPDX-License-Identifier: MIT
/// \file
/// How the thresholds of a session were measured: the array file's [calibration].
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/session/prepared.hpp"

namespace tactor::study {

/// What is wrong with a calibration for a session whose level is above the thresholds; nothing where there is
/// none.
std::vector<std::string> calibration_doubts(const std::string& participant, const session::environment& e,
                                            const stimulus_set& stimuli);

/// What session.json says of it; null: none.
nlohmann::ordered_json calibration_facts(const prepared_experiment& p);

} // namespace tactor::study
