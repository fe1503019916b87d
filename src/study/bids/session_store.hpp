// SPDX-License-Identifier: MIT
/// \file
/// A participant's session on the disk: the facts with which it began, its stimuli, and its trials. Each
/// trial is on the disk before the next one begins.
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

/// The runs of a session in their order. The definition must live as long.
using runs_in_order = std::vector<const run_definition*>;

class session_store {
public:
    /// Prepares a new session, or with `resume` an existing one. `facts` go into session.json. The facts of
    /// an existing session must be the same, except those that `may_differ` lists.
    /// \throws error: bad_input if the session exists without `resume`, if it does not exist with `resume`,
    ///         or if it began with other facts; runtime for what the system refuses.
    session_store(study_folder& folder, runs_in_order runs, const nlohmann::ordered_json& facts, bool resume);
    ~session_store();
    session_store(const session_store&) = delete;
    session_store& operator=(const session_store&) = delete;

    /// Checks, before anybody answers, that there will be a place for each answer: tries each name that the
    /// session will write, and whether the disk has room for a new one. \throws as study::try_to_write().
    void try_to_write(const std::vector<stimulus>& stimuli) const;

    /// Writes session.json and the files of the study, if they do not exist, and each plan under its hash.
    /// `events`: the description of append_event()'s tables; null if there are none.
    void begin(const std::vector<stimulus>& stimuli, const nlohmann::ordered_json& events = nullptr);

    /// Reads the tables as the analysis does. \throws error (bad_input) with file and line, also if a run has
    /// no table but a later run has one.
    void check_tables() const;
    /// Refuses tables whose last line is cut off. \throws error (bad_input).
    void refuse_cut_lines() const;
    /// Cuts off the rest of a line that a crash left, and keeps it next to the table. Adds participant and
    /// runs to their lists if they are missing there. Returns a sentence for each of these changes. Call it
    /// after check_tables(). \throws error (runtime).
    std::vector<std::string> mend();

    /// Returns true if this session continues an earlier one.
    bool resumed() const noexcept { return resumed_; }
    /// Returns true if anything of the session is on the disk.
    bool begun() const { return resumed_ || begun_; }

    /// Reads the lines of a run's table so far, or those of the practice before it.
    std::vector<trial_row> rows(const run_definition& r) const;
    std::vector<trial_row> practice_rows(const run_definition& r) const;

    /// Adds a line, which is on the disk when this returns. The first line of a run makes the table and
    /// enters participant and run into their lists; `acq_time` is the time of the run's first sample.
    /// \throws error (runtime); if the disk is full, after the line was written into the reserved room.
    void append(const run_definition& r, const trial_row& row, const std::string& acq_time);
    void append_practice(const run_definition& r, const trial_row& row);
    /// Adds a line to the events of a run, sub-CODE_task-NAME_events.tsv, in the order of the cells.
    void append_event(const run_definition& r, const named_cells& cells);

    const study_folder& folder() const noexcept { return folder_; }
    /// Returns how many items of a questionnaire have an answer; `after`: see study_folder::has_answers().
    std::size_t count_answers(const questionnaire& q, const std::string& after) const;
    /// Keeps the answer to an item, which is the next one or an earlier one, in session.json. Once each item
    /// has an answer, writes all of them into the questionnaire's table. The answer is on the disk when this
    /// returns.
    /// \throws error (runtime) as append().
    void keep_answer(const questionnaire& q, const std::string& after, std::size_t item,
                     const std::string& answer);

    /// Makes the run's last trial void, in a file written whole. \throws error (runtime).
    void make_last_void(const run_definition& r);
    /// Returns the time of the run's first sample; nothing before append().
    std::optional<std::string> acq_time(const run_definition& r) const;

    /// Rewrites session.json with this key changed.
    void note(const std::string& key, const nlohmann::ordered_json& value);
    const nlohmann::ordered_json& facts() const noexcept { return facts_; }

private:
    std::filesystem::path table(const run_definition& r) const;
    std::filesystem::path event_table(const run_definition& r) const;
    std::string scan_name(const run_definition& r) const;
    std::vector<std::string> begun_answers(const std::string& form) const;
    void write_facts() const;
    void undo_begin(const std::vector<stimulus>& stimuli) noexcept;
    void reserve();
    void release() noexcept;
    template <class Write>
    void keep(const Write& write);
    void write_line(const std::filesystem::path& file, const named_cells& cells);

    /// A table with a line of this process, and the size and time that the table had after it. The next line
    /// needs only the columns, unless somebody else has changed the table.
    struct written_table {
        text_table columns;
        std::pair<std::uintmax_t, std::filesystem::file_time_type> state;
    };

    study_folder& folder_;
    runs_in_order runs_;
    nlohmann::ordered_json facts_;
    std::filesystem::path source_; ///< sourcedata/sub-CODE; with several sessions sourcedata/sub-CODE/ses-N
    bool resumed_ = false;
    bool begun_ = false; ///< by this process
    std::map<std::filesystem::path, written_table> written_ = {};
};

} // namespace tactor::study
