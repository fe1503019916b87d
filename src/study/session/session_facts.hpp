// SPDX-License-Identifier: MIT
/// \file
/// Facts of an experiment as JSON: what session.json and --dry-run say, of [calibration] too.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/experiment/simulated.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {

/// Facts that are known before a session begins. Others are noted while it goes on.
nlohmann::ordered_json describe_session(const prepared_experiment& p,
                                        const std::optional<simulation>& simulate, const std::string& masker);

nlohmann::ordered_json level_facts(const experiment_definition& d);
/// Noise that the definition asks for; null: none.
nlohmann::ordered_json masking_facts(const masking_definition& m);
/// Each stimulus with the hash that names it.
nlohmann::ordered_json stimulus_facts(const prepared_experiment& p);

/// What is wrong with a calibration for a session whose level is above the thresholds; nothing where there is
/// none.
std::vector<std::string> calibration_doubts(const std::string& participant, const session::environment& e,
                                            const stimulus_set& stimuli);

/// What session.json says of it; null: none.
nlohmann::ordered_json calibration_facts(const prepared_experiment& p);

} // namespace tactor::study
