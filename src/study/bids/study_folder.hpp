// SPDX-License-Identifier: MIT
/// \file
/// The folder of a study (BIDS), as it is written: what is of the study, and the lists of people and runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "study/bids/disk.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {

/// Letters and digits. \throws error (bad_input) for any other code of a participant.
void check_code(const std::string& code);

/// Holds the folder, alone, as long as it lives. One thread.
class study_folder {
public:
    /// Makes the folder, or takes one that is a study's. `d` must live as long. One that was made and is
    /// empty at the end is removed.
    /// \throws error: bad_input where the folder has other things in it, another session is running in it, or
    ///         somebody in it had another experiment, or was real where this is simulated, or the other way
    ///         round; runtime for what the system refuses.
    study_folder(std::filesystem::path folder, const experiment_definition& d, bool simulated);
    ~study_folder();
    study_folder(const study_folder&) = delete;
    study_folder& operator=(const study_folder&) = delete;

    const std::filesystem::path& path() const noexcept { return folder_; }

    /// What differs from the sessions that are there and is allowed to, a sentence each.
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

    std::filesystem::path description_of(const run_definition& r) const;
    std::filesystem::path scans_of(const std::string& code) const;

    /// Tries whether what is of the study, and lists a participant, can be written. \throws as
    /// study::try_to_write().
    void try_to_write(const std::string& code) const;

    /// Writes what is of the study where it is not there yet: dataset_description.json, README,
    /// participants.json, a description of each run's table. Where there is a session.json already, which
    /// says what the folder is of. \throws error (runtime).
    void describe() const;

    /// Somebody who is here already and whose code differs from this one in capitals only; empty for nobody.
    std::string alike(const std::string& code) const;

    /// What is there of the study when a session of this participant has ended, plans and tables but for
    /// those of the whole study apart.
    std::vector<std::filesystem::path> files_of(const std::string& code) const;

    /// Reads participants.tsv and sub-CODE_scans.tsv, where they are there. \throws error (bad_input) with
    /// file and line: see read_participants().
    void check_lists(const std::string& code) const;

    /// Adds a line to participants.tsv, with n/a in what it asks besides. Returns false where there is one.
    bool add_participant(const std::string& code);

    /// Enters a run's table, whose name counts from sub-CODE on, into sub-CODE_scans.tsv, or its time anew.
    void add_scan(const std::string& code, const std::string& file_name, const std::string& acq_time);

    /// The time that add_scan() entered for a table; nothing where there is none.
    std::optional<std::string> scan_time(const std::string& code, const std::string& file_name) const;

    /// Tells programs that read BIDS, by .bidsignore, to leave alone what cut_file() keeps.
    void ignore_cut_lines() const;

private:
    void refuse_others(const experiment_definition& d, bool simulated);

    std::filesystem::path folder_;
    bool is_new_;
    folder_lock lock_;
    const experiment_definition& definition_;
    bool simulated_;
    std::vector<std::string> warnings_ = {};
};

// The texts of the files that describe a study. Each says so where nobody was asked.

/// Returns dataset_description.json.
std::string dataset_text(const experiment_definition& d, bool simulated);
/// Reads from a dataset_description.json whether the study is simulated; nothing where tactor experiment did
/// not write it.
std::optional<bool> says_simulated(const std::string& dataset_description);
/// Returns README.
std::string readme_text(const experiment_definition& d, bool simulated);
/// Returns participants.json.
std::string participants_text(bool simulated);
/// Returns task-NAME_beh.json.
std::string task_text(const run_definition& r, bool simulated);

} // namespace tactor::study
