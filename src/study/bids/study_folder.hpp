// SPDX-License-Identifier: MIT
/// \file
/// The folder of a study (BIDS) that tactor writes: the descriptions, the lists of participants and runs, and
/// times in the format of BIDS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/bids/disk.hpp"
#include "study/data/definition.hpp"

namespace tactor::study {

/// Checks that a participant's code is letters and digits. \throws error (bad_input).
void check_code(const std::string& code);

/// Returns the name of the file that describes the events of a run's trials. A session that sends codes to a
/// recorder writes events.
std::string events_description_path(const run_definition& r);

/// A folder that this process made, which is removed at the end if it is empty.
struct made_folder {
    std::filesystem::path path; ///< empty if the folder was there before

    ~made_folder();
};

/// The folder of a study, used by the session of one participant. For one thread. Sessions of several
/// participants may use the folder at the same time.
class study_folder {
public:
    /// Makes the folder, or opens the existing folder of a study. `d` must outlive this object. \throws
    /// error: bad_input if the folder contains other files, or another session of the participant is
    ///         running in the folder; runtime for other errors of the system.
    study_folder(std::filesystem::path folder, const experiment_definition& d, std::string code,
                 bool simulated);
    study_folder(const study_folder&) = delete;
    study_folder& operator=(const study_folder&) = delete;

    const std::filesystem::path& path() const noexcept { return folder_; }
    /// Code of the session's participant.
    const std::string& code() const noexcept { return code_; }
    session_number session() const noexcept { return definition_.session; }

    /// Compares this session with all sessions that have begun in the folder. Returns warnings about allowed
    /// differences, codes that look alike, and earlier sessions that are missing.
    /// \throws error (bad_input) if a session had another experiment, the participant was in another group,
    ///         another code differs only in capitals, or real and simulated sessions would be mixed.
    std::vector<std::string> check_other_sessions() const;

    /// Takes the lock under which sessions change the files that they share. A caller that has the lock must
    /// not call this function, or a function below that takes the lock.
    detail::owned_fd lock() const { return lock_folder(folder_); }

    /// Returns true if a session in the folder sent codes to a recorder.
    bool has_codes() const;

    /// Returns the path of the list of the session's runs, sub-CODE_scans.tsv.
    std::filesystem::path scans_path() const;

    /// Writes the descriptions that do not exist yet: dataset_description.json, README, participants.json,
    /// and a description of each run's tables. Call it under lock(), after session.json is written. \throws
    /// error (runtime).
    void write_descriptions() const;

    /// Lists the descriptions and lists that the session writes. Leaves out plans and trials.
    std::vector<std::filesystem::path> list_files() const;

    /// Reads participants.tsv, scans_path() and the tables of questionnaires, if they exist.
    /// \throws error (bad_input) with file and line if participants.tsv has another group for the
    ///         participant, if a questionnaire's table lacks a column, and as read_participants() does.
    void check_lists() const;

    /// Adds the participant to participants.tsv, with the group, and n/a in the other columns. Returns false
    /// if the participant has a line already. Takes lock().
    bool add_participant();

    /// Adds a run's table to scans_path(), or changes the time of a table that is already listed.
    /// `file_name`: relative to the folder of the session.
    void add_scan(const std::string& file_name, const std::string& acq_time);

    /// Returns the time that add_scan() entered for a table, if any.
    std::optional<std::string> scan_time(const std::string& file_name) const;

    /// Returns true if the table of a questionnaire has the participant's answers. `after`: name of the run
    /// before the questionnaire; empty if the questionnaire is not asked between runs.
    bool has_answers(const questionnaire& q, const std::string& after) const;

    /// Add all answers, in the order of the items, or change one answer. Both functions take lock(), and
    /// rewrite the whole table. \throws error.
    void add_answers(const questionnaire& q, const std::string& after,
                     const std::vector<std::string>& answers) const;
    void change_answer(const questionnaire& q, const std::string& after, std::size_t item,
                       const std::string& answer) const;

    /// Adds the files that split_file() makes to .bidsignore, so that programs for BIDS ignore them. Takes
    /// lock().
    void ignore_cut_lines() const;

private:
    void ignore(const std::string& pattern) const;

    std::filesystem::path folder_;
    made_folder made_;
    const experiment_definition& definition_;
    std::string code_;
    bool simulated_;
    std::optional<held_file> own_ = {}; ///< lock file that prevents another session of the participant
};

/// Returns the text of dataset_description.json. It says if the study is simulated.
std::string dataset_text(const experiment_definition& d, bool simulated);
/// Returns true if a dataset_description.json describes a simulated study, or nothing if tactor experiment
/// did not write it.
std::optional<bool> parse_simulated_flag(const std::string& dataset_description);

/// Returns a time such as "2026-11-21T14:03:00.123456Z", UTC. `utc_ns`: ns since 1970, rounded down to us.
std::string acq_time_text(std::int64_t utc_ns);

/// Reads a time in the form of acq_time_text(), with or without the Z. Returns ns since 1970, or nothing for
/// other texts.
std::optional<std::int64_t> parse_acq_time(const std::string& text);

} // namespace tactor::study
