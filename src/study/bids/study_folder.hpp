// SPDX-License-Identifier: MIT
/// \file
/// The folder of a study (BIDS), as tactor writes it: its descriptions, the lists of people and runs, and
/// times in the form that BIDS wants.
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

/// Returns the name of the file that describes the events of a run's trials, if codes are sent.
std::string events_description(const run_definition& r);

/// A study's folder with a participant's session, for one thread. Sessions of several participants may run in
/// it at once.
class study_folder {
public:
    /// Makes the folder, or takes an existing folder of a study. `d` must live as long. The destructor
    /// removes a folder that this made, if it is empty.
    /// \throws error: bad_input if the folder has other things in it or another session of the participant
    ///         is running in it, and as check_others(); runtime for what the system refuses.
    study_folder(std::filesystem::path folder, const experiment_definition& d, std::string code,
                 bool simulated);
    ~study_folder();
    study_folder(const study_folder&) = delete;
    study_folder& operator=(const study_folder&) = delete;

    const std::filesystem::path& path() const noexcept { return folder_; }
    /// Code of the participant whose session this is.
    const std::string& code() const noexcept { return code_; }
    session_number session() const noexcept { return definition_.session; }

    /// Compares this session with all that have begun in the folder. Returns sentences about allowed
    /// differences, and about an earlier session that is missing.
    /// \throws error (bad_input) if somebody had another experiment, the participant was in another group, or
    ///         real and simulated sessions would meet.
    std::vector<std::string> check_others() const;

    /// Returns the lock under which sessions change the files that they share. The caller must not have it,
    /// neither here nor in the functions below that take it.
    detail::owned_fd lock() const { return lock_folder(folder_); }

    /// Tests whether a session in the folder sent codes to a recorder.
    bool has_codes() const;

    /// Returns the list of the session's runs: sub-CODE_scans.tsv.
    std::filesystem::path scans() const;

    /// Writes the descriptions that do not exist yet: dataset_description.json, README, participants.json,
    /// and one for each run's tables. Call it under lock(), after session.json is written. \throws error
    /// (runtime).
    void describe() const;

    /// Lists the files that the session makes: descriptions and lists, without plans and trials.
    std::vector<std::filesystem::path> list_files() const;

    /// Reads participants.tsv, scans() and the tables of questionnaires, if they exist.
    /// \throws error (bad_input) with file and line: as read_participants(); if participants.tsv has another
    ///         group for the participant; if a questionnaire's table lacks a column.
    void check_lists() const;

    /// Adds a line to participants.tsv under lock(), with the group, and n/a in the other columns. Returns
    /// false if the participant has a line.
    bool add_participant();

    /// Enters a run's table, named relative to its session's folder, into scans(). If it is there already,
    /// replaces its time.
    void add_scan(const std::string& file_name, const std::string& acq_time);

    /// Returns the time that add_scan() entered for a table, if any.
    std::optional<std::string> scan_time(const std::string& file_name) const;

    /// Returns true if the participant's answers to a questionnaire are in its table; `after`: name of the
    /// run before it, empty unless it is asked between runs.
    bool has_answers(const questionnaire& q, const std::string& after) const;

    /// Adds the answers in the order of the items, or changes one of them. Writes the whole table anew under
    /// lock(). \throws error.
    void add_answers(const questionnaire& q, const std::string& after,
                     const std::vector<std::string>& answers) const;
    void change_answer(const questionnaire& q, const std::string& after, std::size_t item,
                       const std::string& answer) const;

    /// Tells programs that read BIDS to ignore the files of cut_file(), by .bidsignore. Takes lock().
    void ignore_cut_lines() const;

private:
    void ignore(const std::string& pattern) const;

    std::filesystem::path folder_;
    bool is_new_;
    const experiment_definition& definition_;
    std::string code_;
    bool simulated_;
    std::optional<held_file> own_ = {}; ///< keeps out another session of the participant
};

/// Returns dataset_description.json, which says so if the study is simulated.
std::string dataset_text(const experiment_definition& d, bool simulated);
/// Returns true if a dataset_description.json is about a simulated study; nothing if tactor experiment did
/// not write it.
std::optional<bool> says_simulated(const std::string& dataset_description);

/// Returns "2026-11-21T14:03:00.123456Z": UTC, whole microseconds, from ns since 1970.
std::string acq_time_text(std::int64_t utc_ns);

/// Reads such a text, with or without the Z. Returns nothing for any other text.
std::optional<std::int64_t> acq_time_ns(const std::string& text);

} // namespace tactor::study
