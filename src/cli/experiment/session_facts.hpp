// SPDX-License-Identifier: MIT
/// \file
/// Facts of an experiment as JSON: what session.json and --dry-run say.
#pragma once

#include <nlohmann/json.hpp>

#include "cli/experiment/prepared.hpp"

namespace tactor::cli {

/// Facts that are known before a session begins. Others are noted while it goes on.
nlohmann::ordered_json session_facts(const prepared_experiment& p, const experiment_options& o);

nlohmann::ordered_json level_facts(const study::experiment_definition& d);
/// Noise that the definition asks for; null: none.
nlohmann::ordered_json masking_facts(const study::masking_definition& m);
/// Each stimulus with the hash that names it.
nlohmann::ordered_json stimulus_facts(const prepared_experiment& p);

} // namespace tactor::cli
