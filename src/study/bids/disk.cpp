// SPDX-License-Identifier: MIT
#include "study/bids/disk.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "files/output_file.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void throw_disk_error(const fs::path& file, int code)
{
    throw error(error_kind::runtime, file.string(), std::strerror(code),
                fmt::format("earlier answers are kept; {}continue with --resume",
                            code == ENOSPC || code == EDQUOT ? "free some space, and "
                            : code == EROFS                  ? "make the disk writable again, and "
                                                             : ""));
}

// Throws the error for a file that cannot be written. Use it only before the session begins.
[[noreturn]] void refuse_unwritable_file(const fs::path& file, int code)
{
    const bool named_so = code == ENAMETOOLONG;
    throw error(named_so || code == ENOTDIR ? error_kind::bad_input : error_kind::runtime, file.string(),
                fmt::format("it cannot be written: {}", std::strerror(code)),
                named_so ? "use a shorter participant code, or a shorter name for the run"
                : code == ENOSPC || code == EDQUOT
                    ? "free some space; the session has not begun"
                    : "name a folder that can be written; the session has not begun");
}

detail::owned_fd open_file(const fs::path& file, int flags)
{
    detail::owned_fd fd(::open(file.c_str(), flags | O_CLOEXEC | O_NOFOLLOW));
    if (!fd)
        throw_disk_error(file, errno);
    return fd;
}

// Writes a whole text. Returns 0 or an errno.
int write_all(int fd, std::string_view text, bool synced)
{
    while (!text.empty()) {
        const ssize_t n = ::write(fd, text.data(), text.size());
        if (n > 0)
            text.remove_prefix(static_cast<std::size_t>(n));
        else if (n == 0 || errno != EINTR)
            return n == 0 ? ENOSPC : errno;
    }
    return !synced || ::fsync(fd) == 0 ? 0 : errno;
}

} // namespace

std::string json_text(const nlohmann::ordered_json& j)
{
    return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_whole_file(const fs::path& file, std::string_view text)
{
    detail::output_file out(file, {}, detail::owner_kind::program);
    out.write(text.data(), static_cast<std::int64_t>(text.size()));
    if (out.failure() != 0)
        throw_disk_error(file, out.failure());
    out.commit();
}

void check_file_creation(const fs::path& file)
{
    const detail::output_file tried(file);
}

void append_text(const fs::path& file, std::string_view text, bool synced)
{
    const detail::owned_fd d = open_file(file, O_WRONLY | O_APPEND);
    struct stat before {};
    if (::fstat(d.get(), &before) != 0)
        throw_disk_error(file, errno);
    if (const int code = write_all(d.get(), text, synced)) {
        [[maybe_unused]] const int ignored = ::ftruncate(d.get(), before.st_size);
        throw_disk_error(file, code);
    }
}

fs::path split_file(const fs::path& file, std::size_t at)
{
    fs::path kept;
    for (unsigned n = 1; kept.empty() || is_on_disk(kept); ++n)
        kept = file.string() + fmt::format(".cut-{}", n);
    write_whole_file(kept, read_file(file).substr(at));
    const detail::owned_fd d = open_file(file, O_WRONLY);
    if (::ftruncate(d.get(), static_cast<off_t>(at)) != 0 || ::fsync(d.get()) != 0)
        throw_disk_error(file, errno);
    return kept;
}

bool is_on_disk(const fs::path& p) noexcept
{
    std::error_code ignored;
    return fs::exists(fs::symlink_status(p, ignored));
}

void make_folder(const fs::path& folder)
{
    if (::mkdir(folder.c_str(), 0777) == 0) {
        detail::sync_folder(folder.parent_path());
        return;
    }
    const int code = errno;
    std::error_code ignored;
    if (code == ENOSPC || code == EDQUOT)
        throw_disk_error(folder, code);
    if (code != EEXIST || !fs::is_directory(folder, ignored))
        throw error(error_kind::runtime, folder.string(), std::strerror(code == EEXIST ? ENOTDIR : code),
                    "name a folder that can be written");
}

void make_folders(const fs::path& folder, const fs::path& below)
{
    fs::path at = folder;
    for (const fs::path& part : below)
        make_folder(at /= part);
}

void check_writable(const fs::path& file, std::size_t bytes)
{
    fs::path folder = file.parent_path();
    while (!is_on_disk(folder))
        folder = folder.parent_path();
    const std::string tail = ".part"; // remove_leftovers() removes such a file after a crash
    const std::size_t length = std::max(file.filename().string().size(), tail.size() + 2);
    const fs::path probe = folder / ("." + std::string(length - tail.size() - 1, 'x') + tail);
    const detail::owned_fd fd(::open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    bool possible = fd && (!is_on_disk(file) || ::access(file.c_str(), W_OK) == 0);
    int code = errno;
    if (possible && bytes > 0) {
        code = write_all(fd.get(), std::string(bytes, '\n'), false);
        possible = code == 0;
    }
    ::unlink(probe.c_str());
    if (possible)
        return;
    refuse_unwritable_file(file, code);
}

void remove_leftovers(const fs::path& folder) noexcept
{
    std::error_code failed;
    std::vector<fs::path> old;
    for (fs::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed)) {
        const std::string name = i->path().filename().string();
        if (name.starts_with('.') && name.ends_with(".part"))
            old.push_back(i->path());
    }
    for (const fs::path& p : old)
        fs::remove(p, failed);
}

detail::owned_fd lock_folder(const fs::path& folder)
{
    detail::owned_fd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!fd)
        throw error(error_kind::runtime, folder.string(), std::strerror(errno),
                    "name a folder that can be read and written");
    while (::flock(fd.get(), LOCK_EX) != 0)
        if (errno != EINTR)
            throw error(error_kind::runtime, folder.string(), std::strerror(errno),
                        "name a folder that can be locked");
    return fd;
}

held_file::held_file(fs::path file, const error& taken) : file_(std::move(file))
{
    struct stat now {};
    // A link count of 0 means that the process that held the file has removed it: then try again. Opens the
    // file read-only, because a file that is open for writing would prevent remounting the disk read-only.
    while (now.st_nlink == 0) {
        fd_ = detail::owned_fd(::open(file_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (!fd_)
            refuse_unwritable_file(file_, errno);
        if (!detail::lock_file(fd_, 0))
            throw taken;
        if (::fstat(fd_.get(), &now) != 0)
            refuse_unwritable_file(file_, errno);
    }
}

held_file::~held_file()
{
    ::unlink(file_.c_str());
}

} // namespace tactor::study
