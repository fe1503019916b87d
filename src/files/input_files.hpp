// SPDX-License-Identifier: MIT
/// \file
/// The files that this process has read: output must not replace them.
#pragma once

#include <filesystem>

struct stat;

namespace tactor::detail {

/// Owner of the content of a file.
enum class owner_kind {
    user,    ///< a drawing, a recording, an array: replaced by nothing
    program, ///< records that the program reads and brings up to date
};

/// Remembers a file that is read; a descriptor's name is /dev/fd/N. Pipes and devices do not count. Remembers
/// at most 65,536 files. Any thread; blocks on the file system.
void note_input(const std::filesystem::path& file, owner_kind owner = owner_kind::user);

/// The name under which a file was read, or empty. Files of the program count for a writer that is the user's
/// only. An input that has been deleted or replaced since does not count. Any thread; blocks on the file
/// system.
std::filesystem::path find_input(const struct stat& file, owner_kind writer);

/// \throws error (bad_input) with the name `output` where the file at `file` was read as input.
void refuse_input(const struct stat& file, const std::filesystem::path& output,
                  owner_kind writer = owner_kind::user);

} // namespace tactor::detail
