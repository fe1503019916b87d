// SPDX-License-Identifier: MIT
/// \file
/// The log of a calibration: a line a trial, on the disk before the next one begins; and beside it how the
/// session was begun, so that one that goes on is the same.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/owned.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/calibrate/observer.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {

/// The cells of a line, in the order of a new log's columns.
named_cells log_cells(const calibration_record& r);

/// What a session is begun with, as JSON.
std::string settings_text(const calibration_settings& s);

/// The file that says it: that of the log with the extension .json.
std::filesystem::path settings_file(const std::filesystem::path& log);

/// Holds a session against how one was begun, and takes its date. \throws error (bad_input): that is not
/// known, or was otherwise.
void check_beginning(const std::filesystem::path& log, calibration_settings& s);

class calibration_log {
public:
    /// Opens and locks the log, and settles how the session began: a new one writes `s` beside it, one that
    /// resumes takes its date from there.
    /// \throws error: bad_input where a log is there already (not `resume`), it is in use, it is none, or
    ///         it was begun otherwise; runtime for what the system refuses.
    calibration_log(std::filesystem::path file, bool resume, calibration_settings& s);
    /// A log that it made, and in which nothing was answered, is no more.
    ~calibration_log();
    calibration_log(const calibration_log&) = delete;
    calibration_log& operator=(const calibration_log&) = delete;

    /// The lines that were there, but for one that a crash cut off.
    const text_table& lines() const noexcept { return lines_; }
    const std::filesystem::path& file() const noexcept { return file_; }
    /// Cuts off what a crash left of a last line and writes the header where there is none; to be called when
    /// the lines are known to be this session's. Returns the file that keeps what was cut off, if any.
    /// \throws error (runtime).
    std::optional<std::filesystem::path> begin();
    /// Appends a line; it is on the disk when this returns, but of a simulated session, which can be had
    /// again, only written. \throws error (runtime).
    void append(const calibration_record& r);

private:
    void open();
    void remove_empty() const noexcept;
    text_table read_lines() const;
    void settle(bool resume, calibration_settings& s);

    std::filesystem::path file_;
    detail::owned_fd fd_;
    bool synced_;
    bool made_ = false; ///< here, and no answer is in it
    text_table lines_;
};

/// Gives the lines' answers to a session that begins; a simulated observer is asked each of them too, so that
/// it goes on where it was. \throws error (bad_input) with file and line where they are not of this session.
void replay(calibration& c, const calibration_log& log, observer* simulated);

} // namespace tactor::study
