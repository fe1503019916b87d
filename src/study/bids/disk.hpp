// SPDX-License-Identifier: MIT
/// \file
/// Files that survive a crash at any moment: files that are written whole, and text at the end of a file.
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
void write_whole(const std::filesystem::path& file, std::string_view text);

/// Throws the error that write_whole() would throw before it writes anything.
void try_whole(const std::filesystem::path& file);

/// Appends text to a file that exists; if `synced`, it is on the disk when this returns. If that fails,
/// removes what it has written. \throws error (runtime).
void append_text(const std::filesystem::path& file, std::string_view text, bool synced = true);

/// Cuts a file at a byte. First writes the rest to the disk, next to the file, as NAME.cut-1 or with the next
/// free number. Returns that name. \throws error (runtime).
std::filesystem::path cut_file(const std::filesystem::path& file, std::size_t at);

/// Returns true if anything has this name, even a link that leads nowhere.
bool is_on_disk(const std::filesystem::path& p) noexcept;

/// Makes a folder in an existing one. Does nothing if it exists already. \throws error (runtime).
void make_folder(const std::filesystem::path& folder);

/// Makes each folder of the path `below` in a folder that exists. Throws as above.
void make_folders(const std::filesystem::path& folder, const std::filesystem::path& below);

/// Tries another name of the same length, to find out if a file can be written under this name once its
/// folders are made, and if the disk has room for `bytes`. \throws error: bad_input for an impossible name,
/// runtime for what the system refuses.
void try_to_write(const std::filesystem::path& file, std::size_t bytes = 0);

/// Removes the files that a crash in write_whole() left in a folder.
void remove_leftovers(const std::filesystem::path& folder) noexcept;

/// Waits until no other process has the lock of a folder, and has it as long as the result lives. A process
/// must not take it twice. \throws error (runtime).
detail::owned_fd lock_folder(const std::filesystem::path& folder);

/// A file that only one process has at a time. The destructor removes it.
class held_file {
public:
    /// Does not wait. \throws error: bad_input with `taken` if another process has the file, else as
    ///         try_to_write().
    held_file(std::filesystem::path file, const error& taken);
    ~held_file();
    held_file(const held_file&) = delete;
    held_file& operator=(const held_file&) = delete;

private:
    std::filesystem::path file_;
    detail::owned_fd fd_ = {};
};

} // namespace tactor::study
