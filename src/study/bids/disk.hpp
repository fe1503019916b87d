// SPDX-License-Identifier: MIT
/// \file
/// Functions that write files so that they survive a crash at any moment, and locks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include <tactor/error.hpp>

#include "core/owned.hpp"

namespace tactor::study {

/// Returns the text of a JSON file, indented; bytes that are not UTF-8 are replaced.
std::string json_text(const nlohmann::ordered_json& j);

/// Writes a file under another name that begins with a dot, and renames it when it is on the disk. \throws
/// error.
void write_whole_file(const std::filesystem::path& file, std::string_view text);

/// Checks whether write_whole_file() can create the file. Throws the same error if it cannot; writes nothing.
void check_file_creation(const std::filesystem::path& file);

/// Appends text to an existing file. If `synced`, returns only when the text is on the disk. If writing
/// fails, removes the part that was written. \throws error (runtime).
void append_text(const std::filesystem::path& file, std::string_view text, bool synced = true);

/// Cuts off a file at byte `at`. First saves the rest in a new file next to it, NAME.cut-1 or the next free
/// number. Returns the name of the new file. \throws error (runtime).
std::filesystem::path split_file(const std::filesystem::path& file, std::size_t at);

/// Returns true if anything has this name, even a broken link.
bool is_on_disk(const std::filesystem::path& p) noexcept;

/// Makes a folder in an existing folder. Does nothing if the new folder exists already. \throws error
/// (runtime).
void make_folder(const std::filesystem::path& folder);

/// Makes each folder of the path `below` in an existing folder. Throws as make_folder() does.
void make_folders(const std::filesystem::path& folder, const std::filesystem::path& below);

/// Checks whether a file can be written once its folders exist, and whether the disk has room for `bytes`.
/// Writes a temporary file whose name has the same length. \throws error: bad_input for an impossible name,
/// runtime for other errors of the system.
void check_writable(const std::filesystem::path& file, std::size_t bytes = 0);

/// Removes the files that a crash in write_whole_file() left in a folder.
void remove_leftovers(const std::filesystem::path& folder) noexcept;

/// Locks a folder. Waits until no other process has the lock. The lock lasts as long as the result lives. A
/// process must not take the lock twice. \throws error (runtime).
detail::owned_fd lock_folder(const std::filesystem::path& folder);

/// A lock file that only one process holds at a time. The destructor removes the file.
class held_file {
public:
    /// Creates and locks the file. Does not wait. \throws `taken` if another process holds the file; other
    /// errors as check_writable().
    held_file(std::filesystem::path file, const error& taken);
    ~held_file();
    held_file(const held_file&) = delete;
    held_file& operator=(const held_file&) = delete;

private:
    std::filesystem::path file_;
    detail::owned_fd fd_ = {};
};

} // namespace tactor::study
