// SPDX-License-Identifier: MIT
/// \file
/// A file that appears under its name only when it is complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "core/owned.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

/// Maker of the note in which a format keeps a SHA-256. The note contains "sha256", one byte and the digits.
using hash_note = std::function<std::string(std::string_view digits)>;

/// Returns bytes with the note of their SHA-256 at a place in their last 64 kB.
std::string with_hash(std::string bytes, std::size_t at, const hash_note& note);

/// Refuses to replace a file that was read as input. Without `force` it also refuses a file that another
/// program or a person wrote or changed: a regular, non-empty file for whose first 16 kB and last 1 kB
/// `is_ours` returns false, or that lacks the right note of with_hash().
/// \throws error (bad_input).
void check_replaced(const std::filesystem::path& file, bool force,
                    const std::function<bool(std::string_view begin, std::string_view end)>& is_ours,
                    const hash_note& note, owner_kind writer = owner_kind::user);

/// Begin and end of a comment in a text format: "# " and nothing in TOML.
struct comment_marks {
    std::string_view begin;
    std::string_view end;
};

/// Writes a text whole or not at all, and its SHA-256 in a comment on the last line.
/// \throws error as output_file; without `force` also bad_input as check_replaced().
void write_text(const std::filesystem::path& file, const std::string& text, comment_marks comment, bool force,
                owner_kind writer = owner_kind::user);

/// Refuses to replace a file by other bytes, unless `force`. For formats that have no place for a note.
/// \throws error (bad_input).
void check_same(const std::filesystem::path& file, std::string_view bytes, bool force);

/// Syncs the names in a folder (empty: the current one), so that they survive a power cut, too. Ignores
/// failures: some file systems cannot do it.
void sync_folder(const std::filesystem::path& folder) noexcept;

/// A new file in the folder of `file`. commit() gives it that name; the destructor removes it otherwise. So
/// other programs see the old file or the whole new one, which keeps the old one's owner and rights. Follows
/// links, except in a folder in which any user may put one (sticky, such as /tmp). Writes directly, in order,
/// to existing files that are not regular (a device, a pipe) and to names of descriptors (/dev/stdout,
/// /dev/fd/N). One thread at a time; the members may block on the file system, and on a pipe's reader.
class output_file {
public:
    /// Function that returns false to give up. Called some 50 times a second while a pipe has no reader or is
    /// full.
    using patience = std::function<bool()>;

    /// Opens the file. Waits for a reader if `file` is a pipe without one. `writer`: owner of the content.
    /// \throws error: bad_input for an empty name, one that is a folder's, a folder that is missing, a link
    ///         in a sticky folder, or a file that was read as input; runtime if the system refuses.
    explicit output_file(const std::filesystem::path& file, patience go_on = {},
                         owner_kind writer = owner_kind::user);
    ~output_file();
    output_file(const output_file&) = delete;
    output_file& operator=(const output_file&) = delete;

    /// Appends all bytes, or fewer if the system fails or the caller gives up; commit() reports the reason.
    /// Returns the number of bytes written.
    std::int64_t write(const void* data, std::int64_t bytes);

    /// Returns errno of the first write that failed, or 0.
    int failure() const noexcept { return failure_; }
    /// Returns true once `go_on` returned false.
    bool given_up() const noexcept { return given_up_; }
    /// Returns true if no write failed and the caller did not give up.
    bool good() const noexcept { return failure_ == 0 && !given_up_; }
    /// Syncs the file and renames it to its final name. \throws error (runtime) if a write, the sync or the
    /// rename failed, or the caller gave up.
    void commit();

private:
    [[noreturn]] void fail(int code) const;
    void open_descriptor(int descriptor, owner_kind writer);
    void open_directly();
    void open_beside();
    bool still_wanted();
    bool wait_for_room();

    std::filesystem::path name_;      ///< as the user named it, for messages
    std::filesystem::path target_;    ///< links followed
    std::filesystem::path temporary_; ///< in the target's folder, until it replaces the target
    bool directly_ = false;           ///< written without a temporary file: a pipe, a device, a descriptor
    patience go_on_;
    owned_fd fd_;
    int failure_ = 0;
    bool given_up_ = false;
};

/// Writes a file whole or not at all. \throws error as output_file.
void write_file(const std::filesystem::path& file, std::string_view bytes,
                owner_kind writer = owner_kind::user);

} // namespace tactor::detail
