// SPDX-License-Identifier: MIT
/// \file
/// Option --power of tactor experiment. It simulates studies, all at once or in parts, and counts how many of
/// them find a difference.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/experiment/experiment_options.hpp"

namespace tactor::cli {

/// Adds --power, --studies, --part and --merge to a command that already has the other options of experiment.
/// `o` must outlive the command.
void add_power_options(CLI::App& command, experiment_options& o);

/// Prints the power of the design, or writes one part of the simulation to a file. Returns the exit status.
/// If a signal ends the simulation, prints nothing and returns the status for this signal. \throws error
/// (bad_input).
int print_power(const study::prepared_experiment& e, const experiment_options& o);

/// Returns the JSON Schema tactor-power/1.
nlohmann::ordered_json power_schema();

} // namespace tactor::cli
