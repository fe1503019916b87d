// SPDX-License-Identifier: MIT
/// \file
/// A study's folder (BIDS) as values: the outline of its experiment, the columns of its trials, and its data.
/// The analysis reads these files and nothing else:
///
///   participants.tsv                          participant_id: who takes part, in this order
///   sub-CODE/beh/sub-CODE_task-NAME_beh.tsv   the trials, in the columns of trial_columns
///   sourcedata/sub-CODE/session.json          {"simulated": bool, "experiment": {"text": TOML}}, others are
///                                             left alone: the order of motions and methods, and the runs;
///                                             "group": its name, if the experiment has groups
///
/// If the experiment has several sessions, these are in sub-CODE/ses-N/beh/sub-CODE_ses-N_task-NAME_beh.tsv
/// and sourcedata/sub-CODE/ses-N/session.json.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "study/data/text_table.hpp"
#include "study/experiment/questionnaire.hpp"

namespace tactor::study {

class task;

struct run_outline {
    std::string name;
    std::string file_name; ///< the name's letters and digits, which name its files
    const study::task* task = nullptr;
    std::vector<std::string> motions = {}; ///< in the order of the definition
    std::vector<std::string> methods = {}; ///< the same; what is chosen or compared is the last
    unsigned trials = 0;                   ///< 0: the definition does not say
    unsigned scale = 5;                    ///< rate: the highest rating
    bool visual = false;                   ///< rate: a visual analogue scale, without numbers
    std::string vary = {};                 ///< option or stroke parameter that changes; empty: none
    bool on_db_axis = false;               ///< the values are levels in dB
    std::vector<double> values = {};       ///< of `vary`, ascending
    std::optional<double> standard = {};   ///< value of the other stimulus; none: there is no other
    bool catches = false;                  ///< detect: some trials have no stimulus
    std::string question = {};
    std::vector<std::string> labels = {};  ///< of a scale: of each step, of both ends, or none
    std::vector<std::string> choices = {}; ///< words of both answers; empty: the usual ones

    unsigned lowest_rating() const noexcept { return visual ? 0 : 1; }
    friend bool operator==(const run_outline&, const run_outline&) = default;
};

// Bounds of the numbers that a participant may give in a run that estimates, and their greatest length as
// typed.
inline constexpr double least_estimate = 1e-9;
inline constexpr double most_estimate = 1e9;
inline constexpr std::size_t most_estimate_characters = 12;

/// Returns the estimate that a text is, as people type it: digits, with a point or without. Returns nothing
/// for other texts.
std::optional<double> read_estimate(std::string_view text) noexcept;

// Names in the columns of methods for stimuli by no method of the definition.
inline constexpr std::string_view standard_name = "standard"; ///< the stimulus with the standard's value
inline constexpr std::string_view catch_name = "none";        ///< of a trial without a stimulus

/// A group of participants. A run that it lacks has no motions.
struct group_outline {
    std::string name;
    std::vector<run_outline> runs = {}; ///< all of the experiment's, with the group's motions and methods

    friend bool operator==(const group_outline&, const group_outline&) = default;
};

struct experiment_outline {
    std::string name;
    std::vector<run_outline> runs = {};
    std::vector<group_outline> groups = {}; ///< empty: everybody has all runs
    unsigned sessions = 1;                  ///< of each participant
    std::vector<questionnaire> questionnaires = {};

    friend bool operator==(const experiment_outline&, const experiment_outline&) = default;
};

/// Returns the first difference that makes two outlines of two experiments, as `run "marks", labels: [..],
/// then [..]`; empty if there is none. A questionnaire that only one has is no such difference.
std::string find_difference(const experiment_outline& before, const experiment_outline& now);

/// Returns the ratings of a run: "1 to 5", "0 to 100 on a visual analogue scale".
std::string rating_range(const run_outline& run);

/// Returns the runs of a group with their motions and methods, in words.
std::string describe_group(const group_outline& g);

/// Returns the letters and digits of a run's name (BIDS allows no others in a task's).
std::string make_file_name(std::string_view run);

/// Number of a session, from 1; none if the experiment has one session for each participant.
using session_number = std::optional<unsigned>;

/// Returns sub-CODE or sub-CODE_ses-N.
std::string session_name(std::string_view code, session_number session);

// Paths in a study's folder; `code` is the participant's, without sub-.

/// Returns sub-CODE or sub-CODE/ses-N.
std::filesystem::path session_path(std::string_view code, session_number session);
/// Returns sourcedata/sub-CODE or sourcedata/sub-CODE/ses-N.
std::filesystem::path source_path(std::string_view code, session_number session);
/// Returns the path of a run's trials: sub-CODE/beh/sub-CODE_task-NAME_beh.tsv.
std::filesystem::path table_path(std::string_view code, session_number session, const run_outline& run);
/// Returns the path of what describes a run's tables: task-NAME_beh.json.
std::filesystem::path description_path(const run_outline& run);

/// Schema of the sessions that tactor experiment holds.
inline constexpr std::string_view own_schema = "tactor-session/1";

struct session_data {
    bool simulated = false;
    std::string text; ///< of the experiment, TOML
    experiment_outline experiment;
    std::string group = {}; ///< empty: the experiment has none
};

/// Reads a session.json. \throws error (bad_input) with file and, where it has one, line.
session_data read_session(const std::filesystem::path& file);

/// Lists the sessions of a participant that have a session.json or tables, in order; also those that the
/// experiment does not have. \throws error (bad_input) for a folder that cannot be read.
std::vector<session_number> list_sessions(const std::filesystem::path& folder, std::string_view code);

/// A trial as a line of its table. Empty texts and missing values are n/a.
struct trial_row {
    std::optional<double> onset_s = {}; ///< since the run's first sample at the DAC
    double duration_s = 0.0;            ///< from the first stimulus frame to the last, the gap included
    unsigned trial = 0;                 ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::string group = {};
    session_number session = {};
    std::string motion = {};
    std::string method_1 = {};
    std::string method_2 = {};
    std::string response = {};
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< none: without an answer, or of a version that did not record it
    std::optional<unsigned> rating = {};
    std::optional<double> value = {};   ///< of what the run varies; none: it varies nothing, or a catch trial
    std::optional<unsigned> track = {}; ///< adaptive: from 1
    std::optional<double> intensity_estimate = {};
    bool is_void = false;
    unsigned xruns = 0;
    unsigned stream = 0; ///< counts openings of the device, from 1
    std::optional<std::uint64_t> frame_1 = {};
    std::optional<std::uint64_t> frame_2 = {};
    std::string plan_1 = {}; ///< SHA-256
    std::string plan_2 = {};
};

/// Reader that needs a column.
enum class column_use {
    analysis, ///< the analysis of each task, and sessions that go on
    session,  ///< sessions that go on; the analysis of the tasks that have it
    nobody,   ///< none: tables of older versions do not have it
    some,     ///< none: only studies in which it is not n/a have it
    values,   ///< the analysis of runs that vary a value; only these have it
    own,      ///< runs of its task, which alone have it
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
    column_use use = column_use::session;
    unsigned least = 0; ///< of whole numbers
};

/// Columns in the order of a new table.
extern const std::array<trial_column, 23> trial_columns;

/// Returns true if tables of the run have the column, or may.
bool has_column(const run_outline& run, const trial_column& c);

/// Returns the cells of a row, in the order of a new table of these runs; none that is n/a in a column of
/// some studies.
named_cells make_cells(const trial_row& r, const std::vector<const run_outline*>& runs);

/// Reads all columns of all lines. \throws error (bad_input) with file and line.
std::vector<trial_row> read_rows(const text_table& t, const run_outline& run);

/// Tests whether a crash cut the table's last line within its last cell, a plan.
bool is_cut_in_plan(const text_table& t);

/// Reads a table of trials; a last line that a crash cut off is no row of it. \throws error (bad_input)
/// with file and line.
text_table read_trials(const std::filesystem::path& table);

/// A valid trial. `motion` and the methods are indices into the run's lists.
struct trial {
    unsigned place = 0; ///< in the sequence, from 1
    unsigned attempt = 1;
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::size_t method_2 = 0; ///< of choose only
    unsigned response = 0;    ///< as in its table, not of a run that estimates; identify: the motion answered
    double estimate = 0.0;    ///< of a run that estimates: the number that was given
    double value = 0.0;       ///< of what the run varies
    bool positive = false;    ///< felt, different, or more: the comparison was chosen, or the second word
    bool signal = true;       ///< detect: there was a stimulus; same-different: they differed
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< sooner than min_response_s; none: not recorded
    session_number session = {};
};

/// A participant's trials of a run, of all sessions.
struct run_data {
    std::vector<trial> trials = {};
    std::size_t voids = 0; ///< lines that do not count
    unsigned sessions = 1; ///< that the participant has begun
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
    std::vector<std::vector<run_data>> data = {}; ///< by participant, by run: see find_run()
    std::vector<std::string> groups = {};         ///< by participant; empty: without a session, or groups
    std::vector<left_out> excluded = {};          ///< in participants.tsv, not selected
    std::vector<std::string> warnings = {};
};

/// Participants to analyse; codes with or without sub-.
struct selection {
    std::vector<std::string> only = {};              ///< empty: all
    std::map<std::string, std::string> without = {}; ///< the reason for each code; may be empty
};

/// Tests whether two codes may mean one person: 1 and 01, 01 and P01, p1 and P01; but not C01 and P01.
bool are_alike(std::string_view a, std::string_view b);

/// Warning about such codes.
inline constexpr std::string_view alike_codes = "these codes look alike: check whether they are one person";

/// Reads the codes in participants.tsv, without sub-. \throws error (bad_input) with file and line.
std::vector<std::string> read_participants(const text_table& t);

/// Reads the trials of a run. \throws error (bad_input) with file and line: see read_dataset().
run_data read_run(const text_table& t, const run_outline& run);

/// Reads one folder or more of one experiment; of participants who are not selected nothing is opened.
/// \throws error (bad_input) with file and line for what is not as the head of this file says: a code that is
///         not known or in two folders, nobody left, a folder of somebody who is not in participants.tsv,
///         experiments that differ, real and simulated sessions together, sessions that the experiment does
///         not have or of two groups, names and values that the experiment does not know, answers that the
///         task cannot give, a trial that counts twice.
dataset read_dataset(const std::vector<std::filesystem::path>& folders, const selection& who);

/// Returns a run as the participant's group has it, with the motions and methods of their trials.
const run_outline& find_run(const dataset& d, std::size_t participant, std::size_t run);

/// Returns the data of a group alone, with all runs as it has them.
dataset select_group(const dataset& d, const group_outline& g);

/// A cell as the type of its column; no value for n/a.
using cell_value = std::variant<std::monostate, bool, std::uint64_t, double, std::string>;

/// Cells of a trial by name: participant, run, task and simulated, then all trial_columns, then the others of
/// its table as texts. Columns that the table does not have are n/a.
using trial_cells = std::vector<std::pair<std::string, cell_value>>;

/// Reads every line of every table, void trials included, in the order of participants, runs, sessions and
/// lines.
/// \throws error (bad_input) with file and line, as read_dataset(), and for a cell that is not of its type.
std::vector<trial_cells> read_study(const std::filesystem::path& folder, const selection& who);

} // namespace tactor::study
