// SPDX-License-Identifier: MIT
/// \file
/// A participant's session on the disk: the facts at the start, the stimuli and the trials. Each trial is on
/// the disk before the next trial begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/bids/study_folder.hpp"
#include "study/data/text_table.hpp"
#include "study/data/trial.hpp"
#include "study/experiment/trials.hpp"

namespace tactor::study {

/// The runs of a session, in order. The definition must outlive the list.
using runs_in_order = std::vector<const run_definition*>;

/// Requirement of a session's start for the study's folder.
enum class start_kind : unsigned char {
    begin,  ///< no session of the participant
    resume, ///< a session that has begun
    either, ///< nothing
};

class session_store {
public:
    /// Prepares a new session or continues one. `facts` go into session.json. An existing session must have
    /// the same facts, except those that `may_differ` lists. \throws error: bad_input if the session exists
    ///         or does not exist, against `start`, or if it began with other facts; runtime for other errors
    ///         of the system.
    session_store(study_folder& folder, runs_in_order runs, const nlohmann::ordered_json& facts,
                  start_kind start);
    ~session_store();
    session_store(const session_store&) = delete;
    session_store& operator=(const session_store&) = delete;

    /// Checks before the session that it can store all answers: that each file of the session can be written,
    /// and that the disk has room for a new session. \throws as study::check_writable().
    void check_writable(const std::vector<stimulus>& stimuli) const;

    /// Writes session.json and the files of the study, if they do not exist, and each plan in a file named by
    /// the plan's hash. `events`: description of the tables that append_event() writes; null if there are
    /// none.
    void begin(const std::vector<stimulus>& stimuli, const nlohmann::ordered_json& events = nullptr);

    /// Reads the tables as the analysis does. \throws error (bad_input) with file and line, also if a run has
    /// no table but a later run has one.
    void check_tables() const;
    /// Throws error (bad_input) if the last line of a table is cut off.
    void refuse_cut_lines() const;
    /// Moves an incomplete last line of a table, which a crash may have left, to a file next to the table.
    /// Adds the participant to participants.tsv, and the runs to the list of runs, if they are missing.
    /// Returns a sentence for each change. Call it after check_tables(). \throws error (runtime).
    std::vector<std::string> repair_tables();

    /// Returns true if this session continues an earlier one.
    bool resumed() const noexcept { return resumed_; }
    /// Returns true if anything of the session is on the disk.
    bool begun() const { return resumed_ || begun_; }

    /// Read the lines of a run's table so far, or the lines of the practice before the run.
    std::vector<trial_row> rows(const run_definition& r) const;
    std::vector<trial_row> practice_rows(const run_definition& r) const;

    /// Adds a line. Returns when the line is on the disk. The first line of a run creates the table, and adds
    /// the participant and the run to the lists; `acq_time` is the time of the run's first sample.
    /// \throws error (runtime). If the disk is full, writes the line into the reserved room before it throws.
    void append(const run_definition& r, const trial_row& row, const std::string& acq_time);
    void append_practice(const run_definition& r, const trial_row& row);
    /// Adds a line to the table of a run's events, sub-CODE_task-NAME_events.tsv. A new table has the columns
    /// in the order of `cells`.
    void append_event(const run_definition& r, const named_cells& cells);

    const study_folder& folder() const noexcept { return folder_; }
    /// Returns how many items of a questionnaire have an answer; `after`: see study_folder::has_answers().
    std::size_t count_answers(const questionnaire& q, const std::string& after) const;
    /// Stores the answer to the next item or to an earlier item. Keeps the answers in session.json until each
    /// item has an answer; then writes all answers to the questionnaire's table. Returns when the answer is
    /// on the disk. \throws error (runtime) as append().
    void keep_answer(const questionnaire& q, const std::string& after, std::size_t item,
                     const std::string& answer);

    /// Makes the run's last trial void, and replaces the table by a new file. \throws error (runtime).
    void void_last_trial(const run_definition& r);
    /// Returns the time of the run's first sample, or nothing before the first append().
    std::optional<std::string> acq_time(const run_definition& r) const;

    /// Rewrites session.json with this key changed.
    void set_fact(const std::string& key, const nlohmann::ordered_json& value);
    const nlohmann::ordered_json& facts() const noexcept { return facts_; }

    /// Returns the file of a run's table.
    std::filesystem::path table(const run_definition& r) const;

private:
    std::filesystem::path event_table(const run_definition& r) const;
    std::string scan_name(const run_definition& r) const;
    std::vector<std::string> partial_answers(const std::string& form) const;
    void write_facts() const;
    void undo_begin(const std::vector<stimulus>& stimuli) noexcept;
    void reserve();
    void release() noexcept;
    template <class Write>
    void keep(const Write& write);
    void write_line(const std::filesystem::path& file, const named_cells& cells);

    /// A table to which this process has written, and the file's size and time after the last write. If they
    /// are unchanged, the next line needs only the columns, and the table is not read again.
    struct written_table {
        text_table columns;
        std::pair<std::uintmax_t, std::filesystem::file_time_type> state;
    };

    study_folder& folder_;
    runs_in_order runs_;
    nlohmann::ordered_json facts_;
    std::filesystem::path source_; ///< sourcedata/sub-CODE or sourcedata/sub-CODE/ses-N
    bool resumed_ = false;
    bool begun_ = false; ///< true if this process has begun the session
    std::map<std::filesystem::path, written_table> written_ = {};
};

} // namespace tactor::study
