// SPDX-License-Identifier: MIT
/// \file
/// An experiment as the analysis needs it: who and what there is, in which order.
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

/// Letters and digits of a run's name (BIDS allows no others in a task's).
std::string file_name_of(std::string_view run);

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
