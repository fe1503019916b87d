// SPDX-License-Identifier: MIT
/// \file
/// The files that this process has read, which an output must not replace by chance. Sound, pictures, reports
/// and logs replace none of them, under whatever name or link; a record replaces a record, which the program
/// brings up to date; text that a caller of the library writes (Python's write()) replaces any: that caller
/// reads a stroke, an array or a plan, changes it and writes it again.
#pragma once

#include <filesystem>

struct stat;

namespace tactor::detail {

/// Owner of the content of a file that is read or written.
enum class owner_kind {
    user,    ///< reads a drawing, a recording, an array; writes sound, a picture, a report
    program, ///< reads and writes its records
    caller,  ///< writes text through the library
};

/// Remembers a file that is read; a descriptor's name is /dev/fd/N. Pipes and devices do not count. Forgets
/// files that are gone from time to time. Any thread; blocks on the file system.
void note_input(const std::filesystem::path& file, owner_kind owner = owner_kind::user);

/// Refuses to replace a file that was read and that this writer may not replace. An input that has been
/// deleted or replaced since does not count. Any thread; blocks on the file system.
/// \throws error (bad_input) with the name `output`.
void refuse_input(const struct stat& file, const std::filesystem::path& output,
                  owner_kind writer = owner_kind::user);

} // namespace tactor::detail
