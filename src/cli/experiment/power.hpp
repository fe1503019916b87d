// SPDX-License-Identifier: MIT
/// \file
/// tactor experiment --power: simulated studies, whole or in parts, and how many of them find a difference.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/experiment/experiment_options.hpp"

namespace tactor::cli {

/// Adds --power, --studies, --part and --merge to a command that already has the other options of experiment.
/// `o` must outlive it.
void add_power_options(CLI::App& command, experiment_options& o);

/// Prints the power of the design, or writes a part of it; returns the exit status, which is that of a signal
/// where one ended it, with nothing printed. \throws error (bad_input).
int print_power(const study::prepared_experiment& e, const experiment_options& o);

/// Returns the schema tactor-power/1.
nlohmann::ordered_json power_schema();

} // namespace tactor::cli
