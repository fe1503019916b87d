// SPDX-License-Identifier: MIT
/// \file
/// sourcedata/sub-CODE/session.json, as far as the analysis needs it.
#pragma once

#include <filesystem>
#include <string>

#include "study/data/outline.hpp"

namespace tactor::study {

struct session_data {
    bool simulated = false;
    std::string text; ///< of the experiment, TOML
    experiment_outline experiment;
};

/// \throws error (bad_input) with file and, where it has one, line.
session_data read_session(const std::filesystem::path& file);

/// The description of a run's table. \throws error (bad_input) where it is no JSON object, or describes
/// another run.
void check_description(const std::filesystem::path& file, const run_outline& run);

} // namespace tactor::study
