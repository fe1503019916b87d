// SPDX-License-Identifier: MIT
/// \file
/// Files that survive a crash at any moment: whole ones, and lines at the end of one.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/owned.hpp"

namespace tactor::study {

/// Writes a file beside its name, dot-named, and gives it the name when it is on the disk. \throws error.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Appends a line, without its end, to a file that is there; it is on the disk when this returns. Where that
/// fails nothing of it is left. \throws error (runtime).
void append_line(const std::filesystem::path& file, std::string_view line);

/// Cuts off what a crash left of a last line. \throws error (runtime).
void cut_broken_line(const std::filesystem::path& file);

/// Whether anything has this name, be it a link that leads nowhere.
bool there(const std::filesystem::path& p) noexcept;

/// Makes a folder, where it is not there, in one that is. \throws error (runtime).
void make_folder(const std::filesystem::path& folder);

/// Whether a file can be written under this name, when its folders will have been made: tried with another
/// name of that length. \throws error: bad_input for a name that cannot be, runtime for what the system
/// refuses.
void try_to_write(const std::filesystem::path& file);

/// Removes what a crash left of write_whole() in a folder.
void remove_leftovers(const std::filesystem::path& folder) noexcept;

/// Holds a folder against other processes, as long as it lives.
class folder_lock {
public:
    /// \throws error (bad_input) where another has it, (runtime) for what the system refuses.
    explicit folder_lock(const std::filesystem::path& folder);

private:
    detail::owned_fd fd_;
};

} // namespace tactor::study
