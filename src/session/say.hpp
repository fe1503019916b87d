// SPDX-License-Identifier: MIT
/// \file
/// Text for people, which cannot control their terminal.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::session {

/// Returns a name from a file or the command line for a terminal: control characters, which could move its
/// cursor or worse, become escapes such as \x1b or \n.
std::string shown(std::string_view name);

/// Prints text, escaped as above but for line ends, and on a terminal wrapped at words to its width. Never
/// throws for what cannot be written: standard error that is gone (2>&-, a full disk) does not decide whether
/// the work was done, and main() looks after standard output. To the journal each line goes with its level:
/// `kind`, or a warning's where it begins "tactor: warning: ".
void say_text(std::FILE* to, std::string_view text, log_kind kind = log_kind::info);

/// Hands what was printed on standard output to its reader, and never throws, like say_text().
void flush_output();

/// Returns the errno of the first write to standard output by these that failed, else 0.
int output_error();

/// Returns true if systemd reads this stream for its journal.
bool goes_to_journal(std::FILE* to);

/// Prints text on standard output at once, because somebody reads along.
void show(std::string_view text);

/// Shows each line of a text, broken at words even without a terminal.
void show_lines(std::string_view text);

template <typename... T>
void say(std::FILE* to, fmt::format_string<T...> format, T&&... values)
{
    say_text(to, fmt::format(format, std::forward<T>(values)...));
}

/// Says on standard error why the program ends.
template <typename... T>
void say_error(fmt::format_string<T...> format, T&&... values)
{
    say_text(stderr, fmt::format(format, std::forward<T>(values)...), log_kind::error);
}

} // namespace tactor::session
