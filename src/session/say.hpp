// SPDX-License-Identifier: MIT
/// \file
/// Text for people, which fits their terminal and cannot control it.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::session {

/// Returns a name from a file or the command line in a form that is safe on a terminal: control characters,
/// which could move the cursor or worse, become escapes such as \x1b or \n.
std::string make_printable(std::string_view name);

/// Prints text, escaped like make_printable() except for line ends, and wrapped at words on a terminal. Never
/// throws if writing fails: the work counts even if standard error is closed (2>&-) or its disk is full, and
/// main() checks standard output. In the journal each line gets a level: that of a warning if the line begins
/// with "tactor: warning: ", else `kind`.
void say_text(std::FILE* to, std::string_view text, log_kind kind = log_kind::info);

/// Flushes standard output. Never throws, like say_text().
void flush_output();

/// Returns the errno of the first failed write to standard output by these functions, else 0.
int output_error();

/// Returns true if systemd reads this stream for its journal.
bool goes_to_journal(std::FILE* to);

/// Prints text on standard output and flushes it, for a person who reads along.
void show(std::string_view text);

/// Shows a text. Wraps lines at words even without a terminal.
void show_lines(std::string_view text);

template <typename... T>
void say(std::FILE* to, fmt::format_string<T...> format, T&&... values)
{
    say_text(to, fmt::format(format, std::forward<T>(values)...));
}

/// Prints on standard error why the program ends.
template <typename... T>
void say_error(fmt::format_string<T...> format, T&&... values)
{
    say_text(stderr, fmt::format(format, std::forward<T>(values)...), log_kind::error);
}

/// Returns the number of columns that a line printed to `to` may have: one less than its terminal has
/// (clamped to 40 to 200); 79 if `to` is not a terminal or the terminal does not know its size.
std::size_t line_width(std::FILE* to);

/// Breaks text at blanks, so that lines have at most `width` columns if possible. The first line begins with
/// `first`, the other lines with as many blanks.
std::string wrap_text(std::string_view first, std::string_view text, std::size_t width = line_width(stdout));

/// Breaks each line of `text` like wrap_text(). A continued line is indented to the line's last column of
/// words, as in a table or a list of options, or to its first word. If that column begins in the right half
/// of the width, its words go to a new line.
std::string wrap_lines(std::string_view text, std::size_t width);

/// Returns `text` as it is printed to `to`: on a terminal wrap_lines(), else unchanged.
std::string fit_lines(std::FILE* to, std::string text);

} // namespace tactor::session
