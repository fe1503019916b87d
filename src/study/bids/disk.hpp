// SPDX-License-Identifier: MIT
/// \file
/// Files that survive a crash at any moment: whole ones, and text at the end of one.
#pragma once

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string_view>

#include "core/owned.hpp"

namespace tactor::study {

/// Writes a file beside its name, dot-named, and gives it the name when it is on the disk. \throws error.
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Appends text to a file that is there; if `synced` it is on the disk when this returns. Where that fails
/// nothing of it is left. \throws error (runtime).
void append_text(const std::filesystem::path& file, std::string_view text, bool synced = true);

/// Cuts a file at a byte. What follows is on the disk before, beside the file, as NAME.cut-1 or the next
/// number that is free; returns that name. \throws error (runtime).
std::filesystem::path cut_file(const std::filesystem::path& file, std::size_t at);

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

/// What is kept, and what to do, for an errno.
constexpr const char* what_is_kept(int code) noexcept
{
    if (code == ENOSPC || code == EDQUOT)
        return "what was answered before is kept; free some space, and --resume goes on";
    if (code == EROFS)
        return "what was answered before is kept; make the disk writable again, and --resume goes on";
    return "what was answered before is kept; --resume goes on";
}

} // namespace tactor::study
