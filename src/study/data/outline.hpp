// SPDX-License-Identifier: MIT
/// \file
/// An experiment as the analysis needs it: its runs, motions and methods in their order.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tactor::study {

enum class task_kind { choose, rate, identify };
std::string_view to_string(task_kind t) noexcept;

struct run_outline {
    std::string name;
    std::string file_name; ///< the name's letters and digits, which name its files
    task_kind task = task_kind::choose;
    std::vector<std::string> motions = {}; ///< in the order of the definition
    std::vector<std::string> methods = {}; ///< the same; what is chosen or compared is the last
    unsigned trials = 0;                   ///< 0: the definition does not say
    unsigned scale = 5;                    ///< rate: 1 to this

    friend bool operator==(const run_outline&, const run_outline&) = default;
};

struct experiment_outline {
    std::string name;
    std::vector<run_outline> runs = {};

    friend bool operator==(const experiment_outline&, const experiment_outline&) = default;
};

/// Returns the letters and digits of a run's name (BIDS allows no others in a task's).
std::string make_file_name(std::string_view run);

// Paths in a study's folder; `code` is the participant's, without sub-.

/// Returns sourcedata/sub-CODE.
std::filesystem::path source_path(std::string_view code);
/// Returns the path of a run's trials: sub-CODE/beh/sub-CODE_task-NAME_beh.tsv.
std::filesystem::path table_path(std::string_view code, const run_outline& run);
/// Returns the path of what describes a run's tables: task-NAME_beh.json.
std::filesystem::path description_path(const run_outline& run);

struct session_data {
    bool simulated = false;
    std::string text; ///< of the experiment, TOML
    experiment_outline experiment;
};

/// Reads a session.json. \throws error (bad_input) with file and, where it has one, line.
session_data read_session(const std::filesystem::path& file);

} // namespace tactor::study
