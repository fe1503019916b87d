// SPDX-License-Identifier: MIT
/// \file
/// Output files that appear under their names only when they are complete.
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

/// Formats a SHA-256 as a comment in the syntax of the output file. The comment contains "sha256", one byte
/// and the digits.
using hash_note = std::function<std::string(std::string_view digits)>;

/// Returns `bytes` with a note of their SHA-256 inserted at offset `at`, which is in the last 64 kB.
std::string insert_hash(std::string bytes, std::size_t at, const hash_note& note);

/// Refuses to replace a file that was read as input. Without `force`, also refuses to replace a file that
/// another program or a person wrote or changed. Such a file is a regular, non-empty file that either lacks
/// the correct note of insert_hash(), or whose first 16 kB and last 1 kB make `is_ours` return false.
/// \throws error (bad_input).
void check_overwrite(const std::filesystem::path& file, bool force,
                     const std::function<bool(std::string_view begin, std::string_view end)>& is_ours,
                     const hash_note& note, owner_kind writer = owner_kind::user);

/// Begin and end of a comment in a text format. In TOML the begin is "# " and the end is empty. Both are
/// empty in a format without comments.
struct comment_marks {
    std::string_view begin;
    std::string_view end;
};

/// Writes a complete text file or none. The last line is a comment with the text's SHA-256, if the format has
/// comments.
/// \throws error as output_file does. Without `force`, also error (bad_input) as check_overwrite() does. If
/// the
///         format has no comments, refuses instead to replace a file that has other content.
void write_text(const std::filesystem::path& file, const std::string& text, comment_marks comment, bool force,
                owner_kind writer = owner_kind::user);

/// Syncs the names in a folder, so that they survive a power cut. An empty `folder` means the current folder.
/// Ignores failures, because some file systems do not support this.
void sync_folder(const std::filesystem::path& folder) noexcept;

/// A new file in the folder of `file`. commit() renames it to `file`; without commit(), the destructor
/// removes it. Other programs therefore see either the old file or the complete new file. The new file has
/// the owner and the permissions of the old one. Follows links, except in folders in which any user may
/// create links (sticky folders, such as /tmp). Existing files that are not regular (devices, pipes) and
/// names of descriptors (/dev/stdout, /dev/fd/N) are written directly and in order. One thread at a time.
/// Members may block on the file system, and on the reader of a pipe.
class output_file {
public:
    /// Function that returns false to give up. It is called about 50 times a second while a pipe is full or
    /// has no reader.
    using patience = std::function<bool()>;

    /// Opens the file. If `file` is a pipe without a reader, waits for a reader. `writer` is the owner of the
    /// content.
    /// \throws error (bad_input) for an empty name, the name of a folder, a missing folder, a link in a
    ///         sticky folder, or a file that was read as input; error (runtime) if the system refuses.
    explicit output_file(const std::filesystem::path& file, patience go_on = {},
                         owner_kind writer = owner_kind::user);
    ~output_file();
    output_file(const output_file&) = delete;
    output_file& operator=(const output_file&) = delete;

    /// Appends all bytes, or fewer if the system fails or the caller gives up. commit() then reports the
    /// reason. Returns the number of bytes written.
    std::int64_t write(const void* data, std::int64_t bytes);

    /// Returns the errno of the first failed write, or 0 if no write failed.
    int failure() const noexcept { return failure_; }
    /// Returns true if `go_on` has returned false.
    bool given_up() const noexcept { return given_up_; }
    /// Returns true if no write failed and the caller did not give up.
    bool good() const noexcept { return failure_ == 0 && !given_up_; }
    /// Syncs the file and renames it to its final name.
    /// \throws error (runtime) if a write, the sync or the rename failed, or if the caller gave up.
    void commit();

private:
    [[noreturn]] void fail(int code) const;
    void open_descriptor(int descriptor, owner_kind writer);
    void open_directly();
    void open_temporary();
    bool should_continue();
    bool wait_for_room();

    std::filesystem::path name_;      ///< name from the user, for messages
    std::filesystem::path target_;    ///< name after following links
    std::filesystem::path temporary_; ///< file in the target's folder that will replace the target
    bool directly_ = false;           ///< true for a pipe, a device or a descriptor: no temporary file
    patience go_on_;
    owned_fd fd_;
    int failure_ = 0;
    bool given_up_ = false;
};

/// Writes a complete file or none. \throws error as output_file does.
void write_file(const std::filesystem::path& file, std::string_view bytes,
                owner_kind writer = owner_kind::user);

} // namespace tactor::detail
