// SPDX-License-Identifier: MIT
/// \file
/// Reads a study's folder (BIDS): sessions, columns of trials, and data. The analysis reads only these files:
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

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "study/data/drawing.hpp"
#include "study/data/outline.hpp"
#include "study/data/text_table.hpp"
#include "study/data/trial.hpp"

namespace tactor::study {

/// Difference between two experiments, as texts for a message.
struct experiment_difference {
    std::string place = {};  ///< such as `in run "marks", `; may be empty
    std::string what = {};   ///< such as "labels"; empty if there is no difference
    std::string before = {}; ///< value in the first experiment; empty if a value is too long for a message
    std::string now = {};    ///< value in the second experiment; empty if `before` is empty

    explicit operator bool() const noexcept { return !what.empty(); }
};

/// Finds the first difference that affects the trials of two experiments, or the meaning of an answer.
/// Ignores questionnaires that only one of the experiments has.
experiment_difference find_difference(const experiment_outline& before, const experiment_outline& now);

/// Schema of a session.json that tactor experiment writes.
inline constexpr std::string_view own_schema = "tactor-session/1";

struct session_data {
    bool simulated = false;
    std::string text; ///< definition of the experiment, TOML
    experiment_outline experiment;
    std::string group = {};                       ///< empty if the experiment has no groups
    std::vector<predicted_path> predictions = {}; ///< predictions for runs with drawings; may be empty
};

/// Reads a session.json. \throws error (bad_input) with the file and, if known, the line.
session_data read_session(const std::filesystem::path& file);

/// Lists a participant's sessions that have a session.json or a folder of tables, in order. Includes sessions
/// that the experiment does not plan. \throws error (bad_input) if a folder cannot be read or the name of a
/// session's folder is wrong.
std::vector<session_number> list_sessions(const std::filesystem::path& folder, std::string_view code);

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

/// Returns the cells of a row in the order of a new table of these runs. Leaves out an n/a cell if only some
/// studies have its column.
named_cells make_cells(const trial_row& r, const std::vector<const run_outline*>& runs);

/// Reads all lines of a run's table with all their columns. \throws error (bad_input) with file and line.
std::vector<trial_row> read_rows(const text_table& t, const run_outline& run);

/// Reads all lines of a table of trials. Columns may be missing. \throws as read_rows().
std::vector<trial_row> read_cells(const text_table& t);

/// Returns true if a crash cut off the table's last line within the last cell, which is the hash of a plan.
bool has_cut_plan_hash(const text_table& t);

/// Reads a table of trials. Leaves out the last line if a crash cut it off. \throws error (bad_input) with
/// file and line.
text_table read_trials(const std::filesystem::path& table);

struct dataset {
    experiment_outline experiment;
    bool simulated = false;
    std::vector<std::string> participants = {};   ///< codes, without sub-
    std::vector<std::vector<run_data>> data = {}; ///< trials by participant and then by run, see find_run()
    std::vector<std::string> groups = {}; ///< each participant's group; empty if unknown or without groups
    std::vector<excluded_person> excluded = {}; ///< participants in participants.tsv who are not selected
    std::string drop_rule = {}; ///< description of the trials that the selection leaves out; empty if none
    std::vector<std::string> warnings = {};
};

/// Participants to analyse. Codes may begin with "sub-".
struct selection {
    std::vector<std::string> only = {};              ///< codes to analyse; empty for all
    std::map<std::string, std::string> without = {}; ///< codes to leave out, with reasons, which may be empty
    bool drop_early = false; ///< true to leave out trials whose answers are marked early
    /// Range of response times, s. Trials outside the range or without a response time are left out.
    std::optional<std::pair<double, double>> response_time_s = {};
};

/// Returns true if two codes may mean the same person, such as 1 and 01, 01 and P01, or p1 and P01. Returns
/// false for C01 and P01.
bool are_similar_codes(std::string_view a, std::string_view b);

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

/// Returns a run with the motions and methods that the participant's group has. Indices in the participant's
/// trials refer to these motions and methods.
const run_outline& find_run(const dataset& d, std::size_t participant, std::size_t run);

/// Returns the data of one group. All runs have the motions and methods of the group.
dataset select_group(const dataset& d, const group_outline& g);

/// Value of a cell, in the type of the column; std::monostate for n/a.
using cell_value = std::variant<std::monostate, bool, std::uint64_t, double, std::string>;

/// Names and values of a trial's cells: participant, run, task and simulated, then all trial_columns, then
/// the other columns of the table as texts. Columns that the table lacks are n/a.
using trial_cells = std::vector<std::pair<std::string, cell_value>>;

/// Reads every line of every table, including void trials, in the order of participants, runs, sessions and
/// lines.
/// \throws error (bad_input) with file and line, as read_dataset() does, and for a cell of the wrong type.
std::vector<trial_cells> read_study(const std::filesystem::path& folder, const selection& who);

} // namespace tactor::study
