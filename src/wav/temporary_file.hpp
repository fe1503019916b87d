// SPDX-License-Identifier: MIT
/// \file
/// A file that appears under its name only when it is complete.
#pragma once

#include <cstdint>
#include <filesystem>

namespace tactor::wav {

/// Opens a new file beside `file`; commit() gives it that name, the destructor removes it otherwise. What
/// exists under the name and is no regular file (a device, a pipe) is written to directly.
class temporary_file {
public:
    /// \throws error: bad_input for a folder that is missing or a name that is a folder's, runtime for what
    ///         the system refuses.
    explicit temporary_file(const std::filesystem::path& file);
    ~temporary_file();
    temporary_file(const temporary_file&) = delete;
    temporary_file& operator=(const temporary_file&) = delete;

    /// All of it, or an error that stays: failure() tells. Returns the bytes written.
    std::int64_t write(const void* data, std::int64_t bytes) noexcept;
    std::int64_t read(void* data, std::int64_t bytes) noexcept;
    std::int64_t seek(std::int64_t offset, int whence) noexcept;
    std::int64_t size() const noexcept;

    /// errno of the first write or seek that failed, or 0.
    int failure() const noexcept { return failure_; }
    /// \throws error (runtime).
    void commit();
    [[noreturn]] void fail(int code) const;

private:
    void open_beside();

    std::filesystem::path asked_;     ///< as the user named it, for messages
    std::filesystem::path target_;    ///< links followed
    std::filesystem::path temporary_; ///< empty: written to directly
    int fd_ = -1;
    int failure_ = 0;
};

} // namespace tactor::wav
