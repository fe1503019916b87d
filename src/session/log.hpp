// SPDX-License-Identifier: MIT
/// \file
/// --verbose and --log FILE: the library's log, a line for each entry.
#pragma once

#include <string>
#include <string_view>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "core/owned.hpp"

namespace tactor::session {

/// Returns the text of a line about a stroke that has ended: its name, the time of its first sample at the
/// DAC (UTC and CLOCK_MONOTONIC), the way in which it ended, and the part that was played at `rate`, Hz.
std::string stroke_text(std::string_view name, const stroke_report& r, unsigned rate);

/// A log with lines of UTC, kind and text: "2026-03-01T09:30:00.125Z warning xrun 1: ...". Outlives the
/// player that writes to it.
class session_log {
public:
    /// Writes to standard error if `verbose`, or to the journal with level and time; appends to a file unless
    /// its name is empty.
    /// \throws error: bad_input for a link, a file that is not regular, and a file with other contents;
    ///         runtime if the system refuses.
    session_log(bool verbose, std::string file);
    session_log(const session_log&) = delete;
    session_log& operator=(const session_log&) = delete;

    /// Returns the log function; empty without --verbose and --log.
    log_function function();

private:
    void open();
    void write(log_kind k, std::string_view text);

    bool verbose_;
    std::string file_;
    detail::owned_fd fd_;
};

} // namespace tactor::session
