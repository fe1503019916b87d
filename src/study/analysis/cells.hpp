// SPDX-License-Identifier: MIT
/// \file
/// From trials to one value for each participant and cell.
#pragma once

#include <optional>
#include <vector>

#include "study/data/dataset.hpp"

namespace tactor::study {

/// By row (method; of choose there is one) and motion.
using cell_values = std::vector<std::vector<double>>;

/// A participant's values in a run: choose: per cent in which the last method was chosen; rate: the mean
/// rating; identify: per cent correct. Nothing where a cell has no trial.
std::optional<cell_values> values_of(const run_outline& run, const std::vector<trial>& trials);

/// The mean of a row: of a participant's cells, each with the same weight.
double average_of(const std::vector<double>& row);

/// What rounding may leave of 0 where values of a run are compared.
double rounding_in(const run_outline& run) noexcept;

/// What the main comparison of a run tests, of one participant. choose: per cent in which the last method was
/// chosen, against 50; rate: the last method's mean less the first's, against 0, nothing where there is one
/// method; identify: per cent correct by the last method, against chance. What rounding leaves of no
/// difference is 0.
std::optional<double> compared_value(const run_outline& run, const cell_values& cells);

/// Per cent of trials in which the first interval was chosen; of choose, with at least one trial.
double first_chosen(const std::vector<trial>& trials);

/// Whether a trial of choose was answered with the last method.
bool last_chosen(const trial& t, const run_outline& run) noexcept;

} // namespace tactor::study
