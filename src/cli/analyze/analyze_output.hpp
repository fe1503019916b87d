// SPDX-License-Identifier: MIT
/// \file
/// Output of `tactor analyze`, from values.
#pragma once

#include "study/bids/dataset.hpp"
#include "study/results/result.hpp"

namespace tactor::cli {

/// Prints the main figure of each result and the p of each comparison, in ten lines or less.
void print_summary(const study::analysis& a);

/// Prints the summary, and then the tables of all results.
void print_tables(const study::analysis& a);

/// Every trial that counts on a line, with tabs between, after lines that begin with # and tell R how to read
/// and fit it.
void print_trials(const study::dataset& d);

/// Prints a line for each participant as CSV, for JASP and SPSS: a column for each cell of each run, empty
/// where the participant is left out of the run; of runs that measure one for each figure.
void print_wide(const study::dataset& d, study::sigmoid kind);

/// Prints all warnings on stderr, but only the first about a missing figure, which the text shows as a dash.
void print_warnings(const study::analysis& a);

} // namespace tactor::cli
