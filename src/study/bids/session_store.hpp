// SPDX-License-Identifier: MIT
/// \file
/// A participant's session on the disk: the facts that it began with, its stimuli, and its trials, each of
/// which is there before the next begins.
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
#include "study/data/dataset.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/trials.hpp"

namespace tactor::study {

/// A session's runs in its order; the definition must live as long.
using runs_in_order = std::vector<const run_definition*>;

class session_store {
public:
    /// Prepares a new session, or with `resume` one that is there. `facts` go into session.json; those of a
    /// session that is there must be the same, except the ones that `may_differ` lists.
    /// \throws error: bad_input if this session is there and not `resume`, or the other way round, or it
    /// began
    ///         with other facts; runtime for what the system refuses.
    session_store(study_folder& folder, runs_in_order runs, const nlohmann::ordered_json& facts, bool resume);
    ~session_store();
    session_store(const session_store&) = delete;
    session_store& operator=(const session_store&) = delete;

    /// Makes sure, before anybody answers, that there will be a place for each answer: tries each name that
    /// the session will write. \throws as study::try_to_write().
    void try_to_write() const;

    /// Writes session.json and the files of the study unless they are there, and each plan under its hash.
    /// `events`: the description of append_event()'s tables; null if there are none.
    void begin(const std::vector<stimulus>& stimuli, const nlohmann::ordered_json& events = nullptr);

    /// Reads the tables as the analysis does. \throws error (bad_input) with file and line, and if a run has
    /// no table and a later one has.
    void check_tables() const;
    /// Refuses tables whose last line is cut off. \throws error (bad_input).
    void refuse_cut_lines() const;
    /// Cuts off what a crash left of a last line and keeps it beside the table; adds participant and runs to
    /// their lists if they are missing there. Returns a sentence for each thing it did. Call it after
    /// check_tables(). \throws error (runtime).
    std::vector<std::string> mend();

    /// Returns true if this session goes on with one that was begun.
    bool resumed() const noexcept { return resumed_; }
    /// Returns true if anything of the session is on the disk.
    bool begun() const { return resumed_ || begun_; }

    /// Reads the lines of a run's table so far, or those of the practice before it.
    std::vector<trial_row> rows(const run_definition& r) const;
    std::vector<trial_row> practice_rows(const run_definition& r) const;

    /// Adds a line; it is on the disk when this returns. The first of a run makes the table and enters
    /// participant and run into their lists; `acq_time` is the time of the run's first sample.
    /// \throws error (runtime): if the disk is full, after the line was written into the reserved room.
    void append(const run_definition& r, const trial_row& row, const std::string& acq_time);
    void append_practice(const run_definition& r, const trial_row& row);
    /// Adds a line to the events of a run, sub-CODE_task-NAME_events.tsv, in the order of the cells.
    void append_event(const run_definition& r, const named_cells& cells);

    const study_folder& folder() const noexcept { return folder_; }
    /// Returns how many items of a questionnaire have an answer; `after`: see study_folder::has_answers().
    std::size_t count_answers(const questionnaire& q, const std::string& after) const;
    /// Keeps the answer to an item, the next one or one before it: in session.json, and all of them in the
    /// questionnaire's table once each has one. It is on the disk when this returns.
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
    void reserve();
    void release() noexcept;
    template <class Write>
    void keep(const Write& write);
    void write_line(const std::filesystem::path& file, const named_cells& cells);

    /// A table that has a line of this process, with the size and time that this left it with: the next line
    /// needs its columns alone, unless somebody else has changed it.
    struct written_table {
        text_table columns;
        std::pair<std::uintmax_t, std::filesystem::file_time_type> state;
    };

    study_folder& folder_;
    runs_in_order runs_;
    nlohmann::ordered_json facts_;
    std::filesystem::path source_; ///< sourcedata/sub-CODE, of several sessions sourcedata/sub-CODE/ses-N
    bool resumed_ = false;
    bool begun_ = false; ///< by this process
    std::map<std::filesystem::path, written_table> written_ = {};
};

} // namespace tactor::study
