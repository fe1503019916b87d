// SPDX-License-Identifier: MIT
/// \file
/// Output of `tactor analyze`, from values.
#pragma once

#include "study/analysis/analysis.hpp"

namespace tactor::cli {

void print_analysis_text(const study::analysis& a);

/// Every trial that counts on a line, with tabs between, after lines that begin with # and tell R how to read
/// and fit it.
void print_trials(const study::dataset& d);

/// Prints a line for each participant as CSV, for JASP and SPSS: a column for each cell of each run, empty
/// where the participant is left out of the run; of runs that measure one for each figure.
void print_wide(const study::dataset& d, study::sigmoid kind);

/// Prints all warnings on stderr, but only the first about a missing figure, which the text shows as a dash.
void print_warnings(const study::analysis& a);

} // namespace tactor::cli
