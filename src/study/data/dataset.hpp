// SPDX-License-Identifier: MIT
/// \file
/// A study's folder (BIDS) as values. The analysis reads these files and nothing else:
///
///   participants.tsv                          participant_id: who takes part, in this order
///   sub-CODE/beh/sub-CODE_task-NAME_beh.tsv   the trials; columns trial attempt motion method_1 method_2
///                                             response rating void response_time, early if it is there,
///                                             others are left alone
///   sourcedata/sub-CODE/session.json          {"simulated": bool, "experiment": {"text": TOML}}, others are
///                                             left alone: the order of motions and methods, and the runs
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "study/data/outline.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {

/// A valid trial. `motion` and the methods are indices into the run's lists.
struct trial {
    unsigned place = 0; ///< in the sequence, from 1
    unsigned attempt = 1;
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::size_t method_2 = 0; ///< of choose only
    unsigned response = 0;    ///< choose: interval 1 or 2; rate: the rating; identify: the motion answered
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< sooner than min_response_s; none: not recorded
};

struct run_data {
    std::vector<trial> trials = {};
    std::size_t voids = 0; ///< lines that do not count
};

/// Somebody whose trials are left out, and why.
struct left_out {
    std::string participant;
    std::string why;
};

struct dataset {
    experiment_outline experiment;
    bool simulated = false;
    std::vector<std::string> participants = {};   ///< codes, without sub-
    std::vector<std::vector<run_data>> data = {}; ///< by participant, by run
    std::vector<left_out> excluded = {};          ///< in participants.tsv, not selected
    std::vector<std::string> warnings = {};
};

/// Participants to analyse; codes with or without sub-.
struct selection {
    std::vector<std::string> only = {};              ///< empty: all
    std::map<std::string, std::string> without = {}; ///< the reason for each code; may be empty
};

/// Reads the codes in participants.tsv, without sub-. \throws error (bad_input) with file and line.
std::vector<std::string> read_participants(const text_table& t);

/// Reads the trials of a run. \throws error (bad_input) with file and line: see read_dataset().
run_data read_run(const text_table& t, const run_outline& run);

/// Reads the folder; of participants who are not selected nothing is opened.
/// \throws error (bad_input) with file and line for what is not as above: a code that is not known, nobody
/// left,
///         a folder of somebody who is not in participants.tsv, experiments that differ, real and simulated
///         sessions together, names that the experiment does not know, answers out of range, a trial that
///         counts twice.
dataset read_dataset(const std::filesystem::path& folder, const selection& who);

} // namespace tactor::study
