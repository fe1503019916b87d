// SPDX-License-Identifier: MIT
/// \file
/// A file that appears under its name only when it is complete.
#pragma once

#include <cstdint>
#include <filesystem>

#include <tactor/api.hpp>

namespace tactor {

/// Opens a new file beside `file`; commit() gives it that name, the destructor removes it otherwise: whoever
/// looks finds the old file, whole, or the new one. Of a link what it points to is replaced. What exists
/// under the name and is no regular file (a device, a pipe) is written to directly. All members may block on
/// the file system; one thread at a time.
class TACTOR_API output_file {
public:
    /// \throws error: bad_input for an empty name, one that is a folder's, or a folder that is missing;
    /// runtime
    ///         for what the system refuses.
    explicit output_file(const std::filesystem::path& file);
    ~output_file();
    output_file(const output_file&) = delete;
    output_file& operator=(const output_file&) = delete;

    /// Writes all of it, or less and an error that stays: failure() tells. Returns the bytes written.
    std::int64_t write(const void* data, std::int64_t bytes) noexcept;
    /// Reads back what was written, from where seek() went; as read(2).
    std::int64_t read(void* data, std::int64_t bytes) noexcept;
    /// As lseek(2).
    std::int64_t seek(std::int64_t offset, int whence) noexcept;
    /// Bytes in the file.
    std::int64_t size() const noexcept;

    /// errno of the first write or seek that failed, or 0.
    int failure() const noexcept { return failure_; }
    /// Closes the file and gives it its name. \throws error (runtime): a write failed before, or this did.
    void commit();
    /// \throws error (runtime) with the file's name, for an errno.
    [[noreturn]] void fail(int code) const;

private:
    void open_beside();

    std::filesystem::path asked_;     ///< as the user named it, for messages
    std::filesystem::path target_;    ///< links followed
    std::filesystem::path temporary_; ///< empty: written to directly
    int fd_ = -1;
    int failure_ = 0;
};

} // namespace tactor
