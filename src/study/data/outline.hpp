// SPDX-License-Identifier: MIT
/// \file
/// Outline of an experiment: the parts of its definition that give its data their meaning. Also names and
/// paths in a study's folder.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/data/questionnaire.hpp"

namespace tactor::study {

class task;

/// A track that each condition of an adaptive run has.
struct adaptive_track {
    unsigned down = 0;     ///< positive answers in a row that move a staircase down; 0 for QUEST+
    bool mirrored = false; ///< true to exchange positive and negative answers, and up and down (staircase)
    std::size_t start = 0; ///< index of a staircase's first value

    friend bool operator==(const adaptive_track&, const adaptive_track&) = default;
};

/// Settings of an adaptive run. Values are given as indices into the run's values.
struct adaptive_options {
    /// Returns true if tracks may end before all their trials are played.
    bool may_end_early() const noexcept { return stop_sd || reversals; }

    std::vector<adaptive_track> tracks = {}; ///< tracks of each condition; empty if the run is not adaptive
    bool two_sided = true;                   ///< false if answers are right or wrong; see read_procedure()
    std::vector<std::size_t> steps = {};     ///< step sizes; every second reversal goes to the next size
    std::vector<double> slopes = {};         ///< slopes for QUEST+: sds of the normal distribution
    std::vector<double> lapses = {};
    std::optional<double> stop_sd = {}; ///< a QUEST+ track ends when the sd of the threshold is below this
    std::optional<unsigned> reversals = {}; ///< number of reversals at which a staircase ends

    friend bool operator==(const adaptive_options&, const adaptive_options&) = default;
};

struct run_outline {
    std::string name;
    std::string file_name; ///< letters and digits of `name`, for file names
    const study::task* task = nullptr;
    std::vector<std::string> motions = {}; ///< names in the order of the definition
    std::vector<std::string> methods = {}; ///< names; the main comparisons are about the last method
    std::vector<unsigned> sessions = {};   ///< numbers of the sessions with the run; empty for all sessions
    unsigned trials = 0;                   ///< number of trials; 0 if the definition does not give it
    unsigned scale = 5;                    ///< highest rating (task rate)
    bool visual = false;                   ///< true for a visual analogue scale, without numbers (task rate)
    std::string vary = {};           ///< name of the option or stroke parameter that changes; empty if none
    bool on_db_axis = false;         ///< true if the values are levels in dB
    std::vector<double> values = {}; ///< values of `vary`, ascending
    std::optional<double> standard = {}; ///< value of the standard stimulus, if the trials have one
    bool catches = false;                ///< true if some trials have no stimulus (task detect)
    adaptive_options adaptive = {};      ///< procedures by which earlier answers choose the values
    std::string question = {};
    std::vector<std::string> labels = {};  ///< labels of a scale's steps, or of the two ends; may be empty
    std::vector<std::string> choices = {}; ///< labels of the two answers; empty for the usual labels

    bool is_adaptive() const noexcept { return !adaptive.tracks.empty(); }
    unsigned lowest_rating() const noexcept { return visual ? 0 : 1; }
    /// Returns true if the run is part of a session. `session`: number of the session, from 1.
    bool is_in_session(unsigned session) const noexcept
    {
        return sessions.empty() || std::ranges::count(sessions, session) != 0;
    }
    friend bool operator==(const run_outline&, const run_outline&) = default;
};

// Names of special stimuli. In the method columns of a table they replace the name of a method.
inline constexpr std::string_view standard_name = "standard"; ///< stimulus with the standard's value
inline constexpr std::string_view catch_name = "none";        ///< trial without a stimulus

/// A group of participants. Runs that the group skips have no motions.
struct group_outline {
    std::string name;
    std::vector<run_outline> runs = {}; ///< all runs of the experiment, with the group's motions and methods

    friend bool operator==(const group_outline&, const group_outline&) = default;
};

struct experiment_outline {
    std::string name;
    std::vector<run_outline> runs = {};
    std::vector<group_outline> groups = {}; ///< empty if everybody does all runs
    unsigned sessions = 1;                  ///< number of sessions of each participant
    std::vector<questionnaire> questionnaires = {};

    friend bool operator==(const experiment_outline&, const experiment_outline&) = default;
};
/// Describes a group's runs with their motions and methods.
std::string describe_group(const group_outline& g);

/// Returns the letters and digits of a run's name: BIDS allows only these in the name of a task.
std::string make_file_name(std::string_view run);

/// Number of a session, from 1. It is missing if each participant has only one session.
using session_number = std::optional<unsigned>;

/// Returns sub-CODE or sub-CODE_ses-N.
std::string session_name(std::string_view code, session_number session);

// Paths in a study's folder. `code` is the participant's code without "sub-".

/// Returns sub-CODE or sub-CODE/ses-N.
std::filesystem::path session_path(std::string_view code, session_number session);
/// Returns sourcedata/sub-CODE or sourcedata/sub-CODE/ses-N.
std::filesystem::path source_path(std::string_view code, session_number session);
/// Returns the path of a run's trials: sub-CODE/beh/sub-CODE_task-NAME_beh.tsv.
std::filesystem::path table_path(std::string_view code, session_number session, const run_outline& run);
/// Returns the path of the description of a run's tables: task-NAME_beh.json.
std::filesystem::path description_path(const run_outline& run);

} // namespace tactor::study
