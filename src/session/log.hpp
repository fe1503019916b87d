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
/// DAC (UTC and CLOCK_MONOTONIC), how it ended, and the duration that was played. `rate`: rate of the stream,
/// Hz.
std::string stroke_text(std::string_view name, const stroke_report& r, unsigned rate);

/// A log with lines of UTC, kind and text: "2026-03-01T09:30:00.125Z warning xrun 1: ...". Must outlive the
/// player that writes to it.
class session_log {
public:
    /// If `verbose`, writes to standard error. If that is the journal, lines have the journal's level and
    /// time. Also appends to a file unless its name is empty.
    /// \throws error: bad_input for a link, a file that is not regular, and a file with other contents;
    ///         runtime if the system refuses.
    session_log(bool verbose, std::string file);
    session_log(const session_log&) = delete;
    session_log& operator=(const session_log&) = delete;

    /// Returns the log function; empty if there is neither --verbose nor --log.
    log_function function();

private:
    void open();
    void write(log_kind k, std::string_view text);

    bool verbose_;
    std::string file_;
    detail::owned_fd fd_;
};

} // namespace tactor::session
