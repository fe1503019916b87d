// SPDX-License-Identifier: MIT
/// \file
/// Files that are pipes: messages while the tool waits for another program.
#pragma once

#include <string>

namespace tactor::session {

/// Says on standard error that the tool waits for a program that writes to a named pipe; call it before a
/// file is read. \throws error (bad_input) for a folder, a terminal, and a pipe that this program itself
/// writes to.
void check_readable(const std::string& file);

/// Returns true if a name is one of this process's standard output (/dev/stdout, /dev/fd/1).
bool is_standard_output(const std::string& file);

/// Refuses standard input that cannot be read, for an errno. \throws error: bad_input if it is closed or a
/// folder, else runtime.
[[noreturn]] void refuse_standard_input(int code);

/// Refuses standard input that cannot be read, before anything else is done. \throws error as above.
void check_standard_input();

/// Says on standard error that the tool waits for a program that reads a named pipe. Else nothing.
void tell_of_pipe_to_write(const std::string& file);

} // namespace tactor::session
