// SPDX-License-Identifier: MIT
/// \file
/// Reads a study's folder (BIDS): the outline of its experiment, the columns of its trials, and its data. The
/// analysis reads only these files:
///
///   participants.tsv                          participant_id: the participants, in this order
///   sub-CODE/beh/sub-CODE_task-NAME_beh.tsv   the trials; trial_columns lists the columns
///   sourcedata/sub-CODE/session.json          {"simulated": bool, "experiment": {"text": TOML}}: the text
///                                             has the runs and the order of motions and methods. "group":
///                                             name of the group, if the experiment has groups.
///                                             "predictions": may be absent. Other keys are ignored.
///
/// If the experiment has several sessions, the files are
/// sub-CODE/ses-N/beh/sub-CODE_ses-N_task-NAME_beh.tsv and sourcedata/sub-CODE/ses-N/session.json.
#pragma once

#include <algorithm>
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

#include "study/data/adaptive_options.hpp"
#include "study/data/drawing.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/questionnaire.hpp"

namespace tactor::study {

class task;

struct run_outline {
    std::string name;
    std::string file_name; ///< letters and digits of `name`, for file names
    const study::task* task = nullptr;
    std::vector<std::string> motions = {}; ///< names in the order of the definition
    std::vector<std::string> methods = {}; ///< the same; main comparisons are about the last one
    std::vector<unsigned> sessions = {};   ///< numbers of the sessions that have the run; empty: all
    unsigned trials = 0;                   ///< number of trials; 0 if the definition does not give it
    unsigned scale = 5;                    ///< rate: the highest rating
    bool visual = false;                   ///< rate: a visual analogue scale, without numbers
    std::string vary = {};           ///< name of the option or stroke parameter that changes; empty if none
    bool on_db_axis = false;         ///< true if the values are levels in dB
    std::vector<double> values = {}; ///< values of `vary`, ascending
    std::optional<double> standard = {}; ///< value of the stimulus to compare with, if a trial has one
    bool catches = false;                ///< detect: some trials have no stimulus
    adaptive_options adaptive = {};      ///< procedures by which earlier answers choose the values
    std::string question = {};
    std::vector<std::string> labels = {};  ///< labels of a scale: for each step, for both ends, or none
    std::vector<std::string> choices = {}; ///< words for the two answers; empty for the usual ones

    bool is_adaptive() const noexcept { return !adaptive.tracks.empty(); }
    unsigned lowest_rating() const noexcept { return visual ? 0 : 1; }
    /// Returns true if a session has the run. `session`: its number, from 1.
    bool is_in(unsigned session) const noexcept
    {
        return sessions.empty() || std::ranges::count(sessions, session) != 0;
    }
    friend bool operator==(const run_outline&, const run_outline&) = default;
};

// Bounds of an estimate that a participant types, and its greatest length in characters.
inline constexpr double least_estimate = 1e-9;
inline constexpr double most_estimate = 1e9;
inline constexpr std::size_t most_estimate_characters = 12;

/// Reads an estimate as people type it: digits, with or without a point. Returns nothing for other texts and
/// for numbers out of bounds.
std::optional<double> read_estimate(std::string_view text) noexcept;

// Names that stand for special stimuli in the method columns, in place of a method of the definition.
inline constexpr std::string_view standard_name = "standard"; ///< stimulus with the standard's value
inline constexpr std::string_view catch_name = "none";        ///< trial without a stimulus

/// A group of participants. A run that the group does not do has no motions.
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

/// Returns the first difference between two experiments that changes their trials or the meaning of an
/// answer, for example `run "marks", labels: [..], then [..]`. Returns an empty text if there is none.
/// Ignores questionnaires that only one of the two has.
std::string find_difference(const experiment_outline& before, const experiment_outline& now);

/// Returns the range of a run's ratings in words: "1 to 5", "0 to 100 on a visual analogue scale".
std::string rating_range(const run_outline& run);

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

/// Schema of a session.json that tactor experiment writes.
inline constexpr std::string_view own_schema = "tactor-session/1";

struct session_data {
    bool simulated = false;
    std::string text; ///< definition of the experiment, TOML
    experiment_outline experiment;
    std::string group = {};                       ///< empty if the experiment has no groups
    std::vector<predicted_path> predictions = {}; ///< for runs in which participants draw; may be empty
};

/// Reads a session.json. \throws error (bad_input) with the file and, if known, the line.
session_data read_session(const std::filesystem::path& file);

/// Lists a participant's sessions that have a session.json or a folder of tables, in order. Includes sessions
/// that the experiment does not plan. \throws error (bad_input) if a folder cannot be read or the name of a
/// session's folder is wrong.
std::vector<session_number> list_sessions(const std::filesystem::path& folder, std::string_view code);

/// A line of a table of trials. Empty texts and missing values are n/a in the file.
struct trial_row {
    std::optional<double> onset_s = {}; ///< time since the run's first sample at the DAC
    double duration_s = 0.0;            ///< time from the first stimulus frame to the last, including the gap
    unsigned trial = 0;                 ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::string group = {};
    session_number session = {};
    std::string motion = {};
    std::string method_1 = {};
    std::string method_2 = {};
    std::string method_3 = {};
    std::string response = {};
    std::string target = {}; ///< target that the task compares the answer with; usually empty
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< missing without an answer, and if an older version wrote the data
    std::optional<unsigned> rating = {};
    std::optional<double> value = {};   ///< value that the run varies, if the trial has one
    std::optional<double> start = {};   ///< value from which the participant moved the comparison
    std::optional<unsigned> moves = {}; ///< number of moves
    std::optional<unsigned> track = {}; ///< track of an adaptive run, from 1
    std::optional<double> intensity_estimate = {};
    bool is_void = false;
    unsigned xruns = 0;
    unsigned stream = 0; ///< number of the opening of the device, from 1
    std::optional<std::uint64_t> frame_1 = {};
    std::optional<std::uint64_t> frame_2 = {};
    std::optional<std::uint64_t> frame_3 = {};
    std::string plan_1 = {}; ///< SHA-256 of the first stimulus' plan
    std::string plan_2 = {};
    std::string plan_3 = {};
};

/// Cells of a trial that each stimulus has.
struct stimulus_cells {
    std::string trial_row::*method;
    std::optional<std::uint64_t> trial_row::*frame;
    std::string trial_row::*plan;
};

/// Greatest number of stimuli of a trial.
inline constexpr std::size_t most_stimuli = 3;

/// Cells of the stimuli, in the order in which they play.
inline constexpr std::array<stimulus_cells, most_stimuli> stimuli_cells{
    {{&trial_row::method_1, &trial_row::frame_1, &trial_row::plan_1},
     {&trial_row::method_2, &trial_row::frame_2, &trial_row::plan_2},
     {&trial_row::method_3, &trial_row::frame_3, &trial_row::plan_3}}};

/// Part of the program that needs a column when it reads tables.
enum class column_use {
    analysis, ///< the analysis of every task, and sessions that resume
    session,  ///< sessions that resume, and the analysis of tasks that use it
    nobody,   ///< nothing needs it; tables of older versions lack it
    some,     ///< nothing needs it; tables have it if the study has values for it
    values,   ///< the analysis of runs that vary a value; other runs lack it
    third,    ///< sessions that resume, and the analysis; tables of trials with fewer stimuli lack it
    own,      ///< the analysis of some tasks, and sessions that resume; other tasks lack it
};

struct trial_column {
    std::string_view name;
    std::string_view meaning; ///< empty if it depends on the task
    std::string_view unit;    ///< empty if none
    std::variant<std::string trial_row::*, double trial_row::*, std::optional<double> trial_row::*,
                 unsigned trial_row::*, std::optional<unsigned> trial_row::*,
                 std::optional<std::uint64_t> trial_row::*, bool trial_row::*,
                 std::optional<bool> trial_row::*>
        member;
    column_use use = column_use::session;
    unsigned least = 0; ///< smallest allowed value, for whole numbers
};

/// Columns in the order of a new table.
extern const std::array<trial_column, 29> trial_columns;

/// Returns true if tables of the run have the column or may have it.
bool has_column(const run_outline& run, const trial_column& c);

/// Returns the cells of a row in the order of a new table of these runs. Leaves out a cell that is n/a if its
/// column is only in some studies.
named_cells make_cells(const trial_row& r, const std::vector<const run_outline*>& runs);

/// Reads all lines of a run's table with all their columns. \throws error (bad_input) with file and line.
std::vector<trial_row> read_rows(const text_table& t, const run_outline& run);

/// Returns true if a crash cut the table's last line within its last cell, the hash of a plan.
bool is_cut_in_plan(const text_table& t);

/// Reads a table of trials. Leaves out the last line if a crash cut it off. \throws error (bad_input) with
/// file and line.
text_table read_trials(const std::filesystem::path& table);

/// A valid trial. `motion` and the methods are indices into the run's lists.
struct trial {
    unsigned place = 0; ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::size_t method_2 = 0; ///< second method, only in choose
    unsigned odd = 0;         ///< oddity: place of the stimulus that differs, from 1
    unsigned response = 0;    ///< answer as in the table (identify: index of the motion); unused in estimate
    double estimate = 0.0;    ///< estimate: number that the participant gave
    drawing drawn = {};       ///< locate, trace: answer
    drawing target = {};      ///< locate, trace: see task::write_target()
    double value = 0.0;       ///< value of what the run varies
    bool positive = false;    ///< true for the answer felt, different or more (comparison or second word)
    bool signal = true;       ///< detect: there was a stimulus; same-different: the stimuli differed
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< sooner than min_response_s; missing if not recorded
    session_number session = {};
    unsigned track = 0; ///< track of an adaptive run, from 1; 0 if not recorded
};

/// A track of an adaptive run in a session.
struct played_track {
    session_number session = {};
    unsigned track = 0; ///< from 1
    std::string motion = {};
    std::string method = {};
    std::string procedure = {};
    std::size_t trials = 0;                    ///< number of trials that count
    bool ended = false;                        ///< true if stop_sd or reversals ended it
    std::optional<std::size_t> reversals = {}; ///< of a staircase
    std::optional<double> sd = {};             ///< QUEST+: posterior sd of the threshold
};

/// A participant's trials of one run in all sessions.
struct run_data {
    std::vector<trial> trials = {};
    std::size_t voids = 0;                        ///< number of void lines, which do not count
    std::size_t dropped = 0;                      ///< number of trials that the selection leaves out
    unsigned sessions = 1;                        ///< number of sessions that the participant has begun
    std::vector<predicted_path> predictions = {}; ///< predictions of the first session, for all runs
    std::vector<played_track> tracks = {};        ///< if tracks may end early; includes dropped trials
};

/// A participant whose trials are left out, with the reason.
struct excluded_person {
    std::string participant;
    std::string why;
};

struct dataset {
    experiment_outline experiment;
    bool simulated = false;
    std::vector<std::string> participants = {};   ///< codes, without sub-
    std::vector<std::vector<run_data>> data = {}; ///< trials by participant and then by run, see find_run()
    std::vector<std::string> groups = {}; ///< by participant; empty if it is not known or there are no groups
    std::vector<excluded_person> excluded = {}; ///< participants in participants.tsv who are not selected
    std::string drop_rule = {}; ///< which trials the selection leaves out, in words; empty: none
    std::vector<std::string> warnings = {};
};

/// Participants to analyse. Codes may begin with "sub-".
struct selection {
    std::vector<std::string> only = {};              ///< codes to analyse; empty for all
    std::map<std::string, std::string> without = {}; ///< codes to leave out, with reasons, which may be empty
    bool drop_early = false; ///< true if trials whose answers are marked early do not count
    /// Response times of trials that count, s; others do not count, nor does a trial without one.
    std::optional<std::pair<double, double>> response_time_s = {};
};

/// Returns true if two codes may mean the same person: 1 and 01, 01 and P01, p1 and P01; but not C01 and P01.
bool are_alike(std::string_view a, std::string_view b);

/// Warning about two codes that are alike.
inline constexpr std::string_view alike_codes = "these codes look alike: check whether they are one person";

/// Reads the codes in participants.tsv, without sub-. \throws error (bad_input) with file and line.
std::vector<std::string> read_participants(const text_table& t);

/// Reads the trials of a run. \throws error (bad_input) with file and line: see read_dataset().
run_data read_run(const text_table& t, const run_outline& run);

/// Reads one or more folders of one experiment. Opens no files of participants who are not selected.
/// \throws error (bad_input) with file and line if a file is not as described above: a code is unknown or in
///         two folders, no participant remains, participants.tsv does not list the participant of a folder,
///         experiments differ, real and simulated sessions are mixed, the experiment does not plan a session,
///         a participant is in two groups, the experiment does not define a name or value, the task does not
///         allow an answer, or a trial counts twice.
dataset read_dataset(const std::vector<std::filesystem::path>& folders, const selection& who);

/// Returns a run as the participant's group does it. The indices in the participant's trials refer to the
/// motions and methods of this run.
const run_outline& find_run(const dataset& d, std::size_t participant, std::size_t run);

/// Returns the data of one group, with all runs as the group does them.
dataset select_group(const dataset& d, const group_outline& g);

/// A cell in the type of its column; std::monostate for n/a.
using cell_value = std::variant<std::monostate, bool, std::uint64_t, double, std::string>;

/// A trial's cells by name: participant, run, task and simulated, then all trial_columns, then the table's
/// other columns as texts. Columns that the table lacks are n/a.
using trial_cells = std::vector<std::pair<std::string, cell_value>>;

/// Reads every line of every table, including void trials, in the order of participants, runs, sessions and
/// lines.
/// \throws error (bad_input) with file and line, as read_dataset() does, and for a cell of the wrong type.
std::vector<trial_cells> read_study(const std::filesystem::path& folder, const selection& who);

} // namespace tactor::study
