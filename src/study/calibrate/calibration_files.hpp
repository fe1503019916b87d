// SPDX-License-Identifier: MIT
/// \file
/// The files of a calibration: its log, with a line for each trial, on the disk before the next one begins;
/// beside it the settings with which the session began, so that a session that goes on is the same; and its
/// result, an array file with the thresholds.
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

/// Compares a session with the settings with which one began, and takes its date. \throws error (bad_input)
/// if these are missing or differ.
void check_beginning(const std::filesystem::path& log, calibration_settings& s);

class calibration_log {
public:
    /// Opens and locks the log. A new session writes `s` beside it, one that resumes takes its date from
    /// there. \throws error: bad_input if a log is there already (not `resume`), it is in use, it is no log,
    ///         or it began with other settings; runtime for what the system refuses.
    calibration_log(std::filesystem::path file, bool resume, calibration_settings& s);
    /// Removes a log that it made, if no answer is in it.
    ~calibration_log();
    calibration_log(const calibration_log&) = delete;
    calibration_log& operator=(const calibration_log&) = delete;

    /// Lines that were there, except one that a crash cut off.
    const text_table& lines() const noexcept { return lines_; }
    /// Cuts off what a crash left of a last line, and writes the header if there is none. Call it once
    /// replay() has found that the lines are this session's. Returns the file that keeps the rest of a cut
    /// line, if any. \throws error (runtime).
    std::optional<std::filesystem::path> begin();
    /// Appends a line; it is on the disk when this returns. A line of a simulated session, which can be
    /// repeated, is only written. \throws error (runtime).
    void append(const calibration_record& r);

private:
    void open();
    void remove_empty() const noexcept;
    text_table read_lines() const;

    std::filesystem::path file_;
    detail::owned_fd fd_;
    bool synced_;
    bool made_ = false; ///< this made the log, and no answer is in it
    text_table lines_;
};

/// Gives the lines' answers to a session that begins. A simulated observer answers each of them too, so that
/// it goes on where it was. \throws error (bad_input) with file and line if they are not of this session.
void replay(calibration& c, const calibration_log& log, observer* simulated);

/// Returns the tables [calibration] and [[calibration.tactor]].
std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

/// Checks that a new file can be made there; leaves nothing behind.
/// \throws error: bad_input for a file that is there already or a folder that is not, runtime for what the
///         system refuses.
void check_new_output(const std::filesystem::path& file);

/// Writes such a file whole or not at all. Throws as above.
void write_new_output(const std::filesystem::path& file, const std::string& text);

/// Checks that an array file is the result of a session. \throws error (bad_input) with the file's name.
void check_finished(const std::filesystem::path& file, const calibration_settings& s);

/// Returns true if an earlier calibration is somebody else's, or only one of the two was simulated.
bool is_foreign(const calibration_origin& earlier, const calibration_settings& s);

/// Returns the array with the measured thresholds. Thresholds of the same participant at other carriers stay,
/// in lists by frequency; those of others go, at all tactors; a measured tactor loses any other threshold
/// that it had. A tactor that was not felt has none at this carrier.
array with_thresholds(array a, const std::optional<calibration_origin>& earlier,
                      const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

struct doubtful_threshold {
    unsigned tactor = 0;
    std::string why = {}; ///< a clause: "it is 20.4 dB above the median of the array's (-44.8 dBFS)"
};

/// Returns the array's thresholds at the session's carrier that are more than 12 dB above their median, and
/// those below which the check trials were still right after the second staircase.
std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured);

} // namespace tactor::study
