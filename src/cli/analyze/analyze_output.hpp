// SPDX-License-Identifier: MIT
/// \file
/// Output of `tactor analyze`. It is made from values only.
#pragma once

#include <string>
#include <string_view>

#include "study/bids/dataset.hpp"
#include "study/results/result.hpp"

namespace tactor::cli {

/// Returns the unit of the quantity that a run varies, such as "mm/s", or "" if it has none. \pre The run
/// varies a quantity.
std::string find_value_unit(const study::run_outline& run);

/// Returns the unit of a figure of a run, such as "dB" for a JND of levels, or "" if it has none.
std::string find_figure_unit(const study::run_outline& run, std::string_view figure);

/// Prints the main figure of each result and the p value of each comparison, in at most ten lines.
void print_summary(const study::analysis& a);

/// Prints the summary, then the tables of all results.
void print_tables(const study::analysis& a);

/// Prints every trial that counts, each on a line of values separated by tabs. Before them come lines that
/// begin with #, with the commands for reading and fitting the trials in R.
void print_trials(const study::dataset& d);

/// Prints a line for each participant as CSV, for JASP and SPSS. It has a column for each cell of each run;
/// runs that measure have a column for each figure instead. A value is empty if the participant is excluded
/// from the run.
void print_wide_table(const study::dataset& d, study::sigmoid kind);

/// Prints all warnings to stderr. Of the warnings about missing figures, which appear as dashes in the text,
/// prints only the first.
void print_warnings(const study::analysis& a);

} // namespace tactor::cli
