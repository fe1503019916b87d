// SPDX-License-Identifier: MIT
/// \file
/// Files that are pipes: what waits for another program says so.
#pragma once

#include <string>

namespace tactor::session {

/// Before a file is read: says on standard error that a named pipe is waited for until a program writes to
/// it. \throws error (bad_input) for a folder, a terminal, and for a pipe that this program itself writes to.
void check_readable(const std::string& file);

/// Whether a name is one of this process's standard output (/dev/stdout, /dev/fd/1).
bool is_standard_output(const std::string& file);

/// Refuses standard input that cannot be read, for an errno. \throws error: bad_input where it is closed or a
/// folder, else runtime.
[[noreturn]] void refuse_standard_input(int code);

/// Refuses standard input that cannot be read, before anything else is done. \throws error as above.
void check_standard_input();

/// Says on standard error that a named pipe is waited for until a program reads it. Else nothing.
void tell_of_pipe_to_write(const std::string& file);

} // namespace tactor::session
