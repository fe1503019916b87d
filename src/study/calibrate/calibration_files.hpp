// SPDX-License-Identifier: MIT
/// \file
/// The files of a calibration. Its log has a line for each trial, which is on the disk before the next trial
/// begins. Next to it are the settings with which the session began, so that a resumed session has the same.
/// Its result is an array file with the thresholds.
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

/// Compares the settings of a session with those at its beginning, and takes the date from there. \throws
/// error (bad_input) if the earlier settings are missing or differ.
void check_beginning(const std::filesystem::path& log, calibration_settings& s);

class calibration_log {
public:
    /// Opens and locks the log. A new session writes `s` next to it; a session that resumes takes its date
    /// from there. \throws error: bad_input if a log exists (without `resume`), it is in use, it is not a
    /// log, or it began with other settings; runtime for what the system refuses.
    calibration_log(std::filesystem::path file, bool resume, calibration_settings& s);
    /// Removes a log that this made, if there is no answer in it.
    ~calibration_log();
    calibration_log(const calibration_log&) = delete;
    calibration_log& operator=(const calibration_log&) = delete;

    /// Lines from earlier, except one that a crash cut off.
    const text_table& lines() const noexcept { return lines_; }
    /// Cuts off the rest of a line that a crash left, and writes the header if there is none. Call it after
    /// replay() has found that the lines belong to this session. Returns the file that keeps the rest of a
    /// cut line, if any. \throws error (runtime).
    std::optional<std::filesystem::path> begin();
    /// Appends a line, which is on the disk when this returns. Lines of a simulated session are only written,
    /// because the session can be repeated. \throws error (runtime).
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

/// Gives the answers in the log to a session that begins. A simulated observer answers each trial, too, so
/// that it continues where it was. \throws error (bad_input) with file and line if the lines do not belong to
/// this session.
void replay(calibration& c, const calibration_log& log, observer* simulated);

/// Returns the tables [calibration] and [[calibration.tactor]].
std::string calibration_text(const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

/// Checks that a new file can be made there. Leaves nothing behind.
/// \throws error: bad_input if the file exists or its folder does not, runtime for what the system refuses.
void check_new_output(const std::filesystem::path& file);

/// Writes a new file whole or not at all. Throws as above.
void write_new_output(const std::filesystem::path& file, const std::string& text);

/// Checks that an array file is the result of a session. \throws error (bad_input) with the file's name.
void check_finished(const std::filesystem::path& file, const calibration_settings& s);

/// Returns true if an earlier calibration is of another participant, or only one of the two was simulated.
bool is_foreign(const calibration_origin& earlier, const calibration_settings& s);

/// Returns the array with the measured thresholds. Keeps thresholds of the same participant at other
/// carriers, in lists by frequency. Removes thresholds of other participants from all tactors, and thresholds
/// of unknown origin from the measured tactors. A tactor that was not felt has none at this carrier.
array with_thresholds(array a, const std::optional<calibration_origin>& earlier,
                      const calibration_settings& s, const std::vector<tactor_threshold>& thresholds);

struct doubtful_threshold {
    unsigned tactor = 0;
    std::string why = {}; ///< a clause: "it is 20.4 dB above the median of the array's (-44.8 dBFS)"
};

/// Returns the array's thresholds at the session's carrier that are more than 12 dB above their median, and
/// those below which the check trials were right even after the second staircase.
std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured);

} // namespace tactor::study
