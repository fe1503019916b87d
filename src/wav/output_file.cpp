// SPDX-License-Identifier: MIT
#include <tactor/output_file.hpp>

#include <cerrno>
#include <random>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor {

namespace fs = std::filesystem;

namespace {

constexpr int attempts = 100;
/// Room for the suffix within the 255 bytes of a name.
constexpr std::size_t longest_stem = 200;

/// The file that a chain of links names, so that the link stays and what it points to is replaced.
fs::path follow_links(fs::path p)
{
    std::error_code ignored;
    for (int i = 0; i < 40 && fs::is_symlink(p, ignored); ++i) {
        const fs::path next = fs::read_symlink(p, ignored);
        p = next.is_absolute() ? next : p.parent_path() / next;
    }
    return p;
}

fs::path folder_of(const fs::path& p)
{
    return p.parent_path().empty() ? fs::path(".") : p.parent_path();
}

[[noreturn]] void refuse(const fs::path& file, const std::string& why, std::string_view hint)
{
    throw error(errc::bad_input, file.string(), why, hint);
}

} // namespace

output_file::output_file(const fs::path& file) : asked_(file), target_(follow_links(file))
{
    if (file.empty()) {
        throw error(errc::bad_input, "file", "its name is empty", "name a file");
    }
    std::error_code failed;
    const fs::file_status there = fs::status(target_, failed);
    if (fs::is_directory(there) || !target_.has_filename()) {
        refuse(asked_, "is a folder", "name a file in it");
    }
    if (fs::exists(there) && !fs::is_regular_file(there)) {
        fd_ = ::open(target_.c_str(), O_RDWR | O_CLOEXEC | O_NOCTTY);
        if (fd_ < 0 && errno == EACCES) {
            fd_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
        }
        if (fd_ < 0) {
            fail(errno);
        }
        return;
    }
    const fs::path folder = folder_of(target_);
    if (!fs::is_directory(folder, failed)) {
        refuse(asked_, fmt::format("the folder \"{}\" does not exist", folder.string()),
               "make it first, or name another");
    }
    if (fs::exists(there) && ::access(target_.c_str(), W_OK) != 0) {
        fail(errno);
    }
    open_beside();
}

void output_file::open_beside()
{
    const std::string stem = target_.filename().string().substr(0, longest_stem);
    std::random_device seed;
    for (int i = 0; i < attempts; ++i) {
        temporary_ = folder_of(target_) / fmt::format(".{}.{:08x}.part", stem, seed());
        fd_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd_ >= 0) {
            return;
        }
        if (errno != EEXIST) {
            break;
        }
    }
    const int code = errno;
    temporary_.clear();
    fail(code);
}

output_file::~output_file()
{
    if (fd_ >= 0) {
        ::close(fd_);
    }
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

void output_file::fail(int code) const
{
    const std::string why = std::error_code(code, std::generic_category()).message();
    std::string_view hint = "check the folder's rights and space";
    if (code == ENOSPC || code == EDQUOT) {
        hint = "free some space, or name a file on another disk; nothing was left behind";
    } else if (code == EFBIG) {
        hint = "the file system or a limit (ulimit -f) does not allow a file of this size";
    } else if (code == EACCES || code == EPERM || code == EROFS) {
        hint = "name a file where you may write";
    }
    throw error(errc::runtime, asked_.string(), fmt::format("cannot be written: {}", why), hint);
}

std::int64_t output_file::write(const void* data, std::int64_t bytes) noexcept
{
    const auto* from = static_cast<const char*>(data);
    std::int64_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::write(fd_, from + done, static_cast<std::size_t>(bytes - done));
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            failure_ = failure_ != 0 ? failure_ : (n < 0 ? errno : ENOSPC);
            break;
        }
        done += n;
    }
    return done;
}

std::int64_t output_file::read(void* data, std::int64_t bytes) noexcept
{
    return ::read(fd_, data, static_cast<std::size_t>(bytes));
}

std::int64_t output_file::seek(std::int64_t offset, int whence) noexcept
{
    const off_t at = ::lseek(fd_, offset, whence);
    if (at < 0 && failure_ == 0) {
        failure_ = errno;
    }
    return at;
}

std::int64_t output_file::size() const noexcept
{
    struct stat s {};
    return ::fstat(fd_, &s) == 0 ? s.st_size : 0;
}

void output_file::commit()
{
    if (failure_ != 0) {
        fail(failure_);
    }
    // A network file system may tell of a full disk only now.
    const int closed = ::close(fd_);
    fd_ = -1;
    if (closed != 0 && errno != EINTR) {
        fail(errno);
    }
    if (!temporary_.empty() && ::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail(errno);
    }
    temporary_.clear();
}

} // namespace tactor
