// SPDX-License-Identifier: MIT
/// \file
/// The files of a calibration. The log has a line for each trial; the line is on the disk before the next
/// trial begins. The settings file, next to the log, has the settings with which the session began, so that a
/// resumed session uses the same settings. The result is an array file with the thresholds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/setup.hpp>

#include "core/owned.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {

/// Returns the settings with which a session begins, as JSON.
std::string settings_text(const calibration_settings& s);

/// Compares the settings of a session with the log's settings file, and copies the date from this file.
/// \throws error (bad_input) if the file is missing or the settings differ.
void check_log_settings(const std::filesystem::path& log, calibration_settings& s);

class calibration_log {
public:
    /// Opens and locks the log. A new session writes `s` to the settings file; a session that resumes reads
    /// the date from this file. \throws error: bad_input if the log exists (without `resume`), is in use, is
    /// not a log, or began with other settings; runtime for other errors of the system.
    calibration_log(std::filesystem::path file, bool resume, calibration_settings& s);
    /// Removes the log if this object created it and it has no answer.
    ~calibration_log();
    calibration_log(const calibration_log&) = delete;
    calibration_log& operator=(const calibration_log&) = delete;

    /// Lines that the log had when it was opened, except a line that a crash cut off.
    const text_table& lines() const noexcept { return lines_; }
    /// Removes an incomplete last line, which a crash may have left, and writes the header if it is missing.
    /// Call it after replay() has checked that the lines belong to this session. Returns the file to
    /// which it moved the incomplete line, if any. \throws error (runtime).
    std::optional<std::filesystem::path> begin();
    /// Appends a line. Returns when the line is on the disk; does not wait for the disk in a simulated
    /// session, which can be repeated. \throws error (runtime).
    void append(const calibration_record& r);

private:
    void open();
    void remove_empty_log() const noexcept;
    text_table read_lines() const;

    std::filesystem::path file_;
    detail::owned_fd fd_;
    bool synced_;
    bool made_ = false; ///< true if this object created the log, and the log has no answer
    text_table lines_;
};

/// Gives the answers in the log to a new calibration. A simulated observer answers each trial again, so that
/// its random numbers continue. \throws error (bad_input) with file and line if the lines do not belong to
/// this session.
void replay(calibration& c, const calibration_log& log, observer* simulated);

/// Returns the tables [calibration] and [[calibration.tactor]].
std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

/// Checks that the new file `file` can be created. Leaves nothing behind.
/// \throws error: bad_input if the file exists or its folder does not exist, runtime for other errors.
void check_new_output(const std::filesystem::path& file);

/// Writes a new file completely or not at all. Throws as check_new_output() does.
void write_new_output(const std::filesystem::path& file, const std::string& text);

/// Checks that an array file is the result of a session. \throws error (bad_input) with the file's name.
void check_calibration_result(const std::filesystem::path& file, const calibration_settings& s);

/// Returns true if an earlier calibration has another participant, or only one of the calibrations is
/// simulated.
bool is_foreign(const calibration_origin& earlier, const calibration_settings& s);

/// Returns the array with the measured thresholds. Keeps thresholds of the same participant at other
/// carriers, in lists by frequency. Removes thresholds of other participants from all tactors, and thresholds
/// of unknown origin from the measured tactors. A tactor that was not felt has no threshold at this carrier.
array merge_thresholds(array a, const std::optional<calibration_origin>& earlier,
                       const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

struct doubtful_threshold {
    unsigned tactor = 0;
    std::string why = {}; ///< such as "it is 20.4 dB above the array's median of -44.8 dBFS"
};

/// Returns the doubtful thresholds of the array at the session's carrier. A threshold is doubtful if it is
/// more than 12 dB above the median, or if too many answers below it were right, even after a second
/// staircase.
std::vector<doubtful_threshold> find_doubtful_thresholds(const array& a, const calibration_settings& s,
                                                         const std::vector<tactor_threshold>& measured);

} // namespace tactor::study
