// SPDX-License-Identifier: MIT
/// \file
/// tactor experiment --power: how often simulated studies come out significant.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "cli/experiment/experiment_options.hpp"
#include "study/session/prepared.hpp"

namespace tactor::cli {

struct power_options {
    std::vector<std::size_t> participants = {}; ///< empty: not asked for
    std::optional<std::size_t> studies = {};    ///< default 200
};

/// `p` must live as long as the command.
void add_power_options(CLI::App& command, power_options& p);

/// What goes together and what is missing. \throws error (bad_input).
void check_power_options(const settings& s, const power_options& p, const experiment_options& o);

/// Prints it; returns the exit status, which is that of a signal where one ended it, with nothing printed.
/// \throws error (bad_input).
int tell_power(const study::prepared_experiment& e, const power_options& p, const experiment_options& o);

} // namespace tactor::cli
