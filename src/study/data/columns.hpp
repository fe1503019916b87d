// SPDX-License-Identifier: MIT
/// \file
/// The columns of the trials in sub-CODE_task-NAME_beh.tsv.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "study/data/text_table.hpp"

namespace tactor::study {

/// A trial as a line of its table. Empty texts and missing values are n/a.
struct trial_row {
    std::optional<double> onset_s = {}; ///< since the run's first sample at the DAC
    double duration_s = 0.0;            ///< from the first stimulus frame to the last, the gap included
    unsigned trial = 0;                 ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::string motion = {};
    std::string method_1 = {};
    std::string method_2 = {};
    std::string response = {};
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< none: without an answer, or of a version that did not record it
    std::optional<unsigned> rating = {};
    bool is_void = false;
    unsigned xruns = 0;
    unsigned stream = 0; ///< counts openings of the device, from 1
    std::optional<std::uint64_t> frame_1 = {};
    std::optional<std::uint64_t> frame_2 = {};
    std::string plan_1 = {}; ///< SHA-256
    std::string plan_2 = {};
};

struct trial_column {
    std::string_view name;
    std::string_view meaning; ///< empty: depends on the task
    std::string_view unit;    ///< empty: none
    std::variant<std::string trial_row::*, double trial_row::*, std::optional<double> trial_row::*,
                 unsigned trial_row::*, std::optional<unsigned> trial_row::*,
                 std::optional<std::uint64_t> trial_row::*, bool trial_row::*,
                 std::optional<bool> trial_row::*>
        member;
    unsigned least = 0;    ///< of whole numbers
    bool may_lack = false; ///< tables of older versions do not have it
};

/// Columns in the order of a new table.
extern const std::array<trial_column, 18> trial_columns;

/// Returns the cells of a row, in the order of a new table.
named_cells make_cells(const trial_row& r);

/// Reads all columns of all lines. \throws error (bad_input) with file and line.
std::vector<trial_row> read_rows(const text_table& t);

/// Tests whether a crash cut the table's last line within its last cell, a plan.
bool is_cut_in_plan(const text_table& t);

/// Reads a table of trials; a last line that a crash cut off is no row of it. \throws error (bad_input)
/// with file and line.
text_table read_trials(const std::filesystem::path& table);

} // namespace tactor::study
