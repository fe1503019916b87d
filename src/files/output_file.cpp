// SPDX-License-Identifier: MIT
#include "files/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/sha256.hpp"
#include "core/split.hpp"

namespace tactor::detail {

namespace fs = std::filesystem;

namespace {

constexpr int attempts = 100;
/// Time between two calls of `go_on`.
constexpr int moment_ms = 20;
/// Longest beginning of a name that a temporary file keeps. It leaves space for a suffix within the 255 bytes
/// of a name.
constexpr std::size_t longest_stem = 200;

fs::path parent_folder(const fs::path& p)
{
    return p.parent_path().empty() ? fs::path(".") : p.parent_path();
}

/// Returns N for the names /dev/fd/N and /proc/self/fd/N, otherwise -1.
int parse_descriptor(const fs::path& p)
{
    const std::string folder = parent_folder(p).string();
    if (folder != "/dev/fd" && folder != "/proc/self/fd")
        return -1;
    return parse_number_text<int>(p.filename().string()).value_or(-1);
}

[[noreturn]] void refuse(const fs::path& file, const std::string& why, std::string_view hint, int code = 0)
{
    throw error(error_kind::bad_input, source_place{file.string()}, why, hint).with_os_code(code);
}

/// Returns true for a folder in which any user may create links. The target of such a link may not be the
/// file that the caller means.
bool is_shared(const fs::path& folder)
{
    struct stat s {};
    return ::stat(folder.c_str(), &s) == 0 && (s.st_mode & S_ISVTX) != 0 &&
           (s.st_mode & (S_IWOTH | S_IWGRP)) != 0;
}

/// Returns the file at the end of a chain of links. Replacing this file keeps the links. Stops at the name of
/// a descriptor.
fs::path follow_links(const fs::path& named)
{
    std::error_code ignored;
    fs::path p = named;
    for (int i = 0; i < 40 && parse_descriptor(p) < 0 && fs::is_symlink(fs::symlink_status(p, ignored));
         ++i) {
        if (is_shared(parent_folder(p))) {
            refuse(named,
                   fmt::format("{} is a link in a folder that others can write to",
                               p == named ? "it" : p.string()),
                   "name the file that you mean");
        }
        const fs::path next = fs::read_symlink(p, ignored);
        p = next.is_absolute() ? next : p.parent_path() / next;
    }
    return p;
}

constexpr std::string_view hash_name = "sha256";

[[noreturn]] void refuse_foreign(const fs::path& file, std::string_view why)
{
    throw error(error_kind::bad_input, source_place{file.string()}, why,
                "choose another name, or use {force=true} to replace the file")
        .with_field("force");
}

/// Returns true if insert_hash() made this file, which has `bytes` bytes. Reads the file in blocks, because
/// samples may have many GB.
bool has_own_hash(std::istream& in, std::uint64_t bytes, const hash_note& note)
{
    constexpr std::size_t block_bytes = 65536;
    constexpr std::size_t digits = 64;
    sha256_sum sum;
    std::string tail;
    std::string block(block_bytes, '\0');
    for (std::uint64_t before = bytes - std::min<std::uint64_t>(bytes, block_bytes); before > 0;) {
        in.read(block.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(before, block_bytes)));
        if (in.gcount() == 0)
            return false;
        sum.add({block.data(), static_cast<std::size_t>(in.gcount())});
        before -= static_cast<std::uint64_t>(in.gcount());
    }
    tail.assign(std::istreambuf_iterator<char>(in), {});
    const std::size_t at = tail.rfind(hash_name);
    if (at == tail.npos || at + hash_name.size() + 1 + digits > tail.size())
        return false;
    const std::string hash = tail.substr(at + hash_name.size() + 1, digits);
    const std::string all = note(hash);
    const std::size_t begin = tail.rfind(all);
    if (begin == tail.npos)
        return false;
    sum.add(tail.erase(begin, all.size()));
    return sum.text() == hash;
}

// Refuses to replace a file that has other bytes, unless `force` is true.
void check_same(const fs::path& file, std::string_view bytes, bool force)
{
    std::error_code unknown;
    if (force || !fs::is_regular_file(file, unknown) || fs::file_size(file, unknown) == 0)
        return;
    std::ifstream in(file, std::ios::binary);
    if (std::string(std::istreambuf_iterator<char>(in), {}) != bytes)
        refuse_foreign(file, "it exists with other content");
}

} // namespace

std::string insert_hash(std::string bytes, std::size_t at, const hash_note& note)
{
    const std::string hash = sha256_text(bytes);
    return bytes.insert(at, note(hash));
}

void check_overwrite(const fs::path& file, bool force,
                     const std::function<bool(std::string_view begin, std::string_view end)>& is_ours,
                     const hash_note& note, owner_kind writer)
{
    constexpr std::size_t begin_bytes = 16384;
    constexpr std::size_t end_bytes = 1024;
    struct stat existing {};
    if (::stat(file.c_str(), &existing) != 0)
        return;
    refuse_input(existing, file, writer);
    if (force || !S_ISREG(existing.st_mode) || existing.st_size == 0)
        return;
    std::ifstream in(file, std::ios::binary);
    std::string begin(begin_bytes, '\0');
    in.read(begin.data(), begin_bytes);
    begin.resize(static_cast<std::size_t>(in.gcount()));
    std::string end = begin;
    if (begin.size() == begin_bytes) {
        in.seekg(-static_cast<std::streamoff>(end_bytes), std::ios::end);
        end.resize(end_bytes);
        in.read(end.data(), end_bytes);
    }
    if (!is_ours(begin, end))
        refuse_foreign(file, "it exists, and tactor did not write it");
    in.clear();
    in.seekg(0);
    if (!has_own_hash(in, static_cast<std::uint64_t>(existing.st_size), note))
        refuse_foreign(file, "somebody changed it after tactor wrote it");
}

void write_text(const fs::path& file, const std::string& text, comment_marks comment, bool force,
                owner_kind writer)
{
    if (comment.begin.empty()) {
        check_same(file, text, force);
        return write_file(file, text, writer);
    }
    constexpr std::string_view what = ": from this line tactor knows whether the text was changed";
    const auto note = [&](std::string_view digits) {
        return fmt::format("\n{}{} {}{}{}\n", comment.begin, hash_name, digits, what, comment.end);
    };
    const auto is_ours = [&](std::string_view, std::string_view end) { return end.find(what) != end.npos; };
    check_overwrite(file, force, is_ours, note, writer);
    write_file(file, insert_hash(text, text.size(), note), writer);
}

void sync_folder(const fs::path& folder) noexcept
{
    const owned_fd fd(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (fd)
        ::fsync(fd.get());
}

output_file::output_file(const fs::path& file, patience go_on, owner_kind writer)
    : name_(file), go_on_(std::move(go_on))
{
    if (file.empty())
        throw error(error_kind::bad_input, "file", "its name is empty", "name a file");
    target_ = follow_links(file);
    if (const int n = parse_descriptor(target_); n >= 0) {
        open_descriptor(n, writer);
        return;
    }
    std::error_code failed;
    const fs::file_status existing = fs::status(target_, failed);
    if (fs::is_directory(existing) || !target_.has_filename())
        refuse(name_, "it is a folder", "name a file in it", EISDIR);
    struct stat s {};
    if (::stat(target_.c_str(), &s) == 0)
        refuse_input(s, name_, writer);
    if (fs::exists(existing) && !fs::is_regular_file(existing)) {
        open_directly();
        return;
    }
    const fs::path folder = parent_folder(target_);
    if (!fs::is_directory(folder, failed)) {
        refuse(name_, fmt::format("the folder \"{}\" does not exist", folder.string()),
               "create it first, or name another", ENOENT);
    }
    if (fs::exists(existing) && ::access(target_.c_str(), W_OK) != 0)
        fail(errno);
    open_temporary();
}

// Duplicates a descriptor. Does not set O_NONBLOCK, which other processes may share: wait_for_room() waits
// with poll() instead.
void output_file::open_descriptor(int descriptor, owner_kind writer)
{
    directly_ = true;
    fd_ = owned_fd(::fcntl(descriptor, F_DUPFD_CLOEXEC, 3));
    struct stat s {};
    if (!fd_ || ::fstat(fd_.get(), &s) != 0)
        fail(errno);
    refuse_input(s, name_, writer);
}

// Opens the file without blocking, because a pipe without a reader would block the program for ever.
void output_file::open_directly()
{
    directly_ = true;
    for (;;) {
        fd_ = owned_fd(::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
        if (fd_)
            return;
        const int code = errno;
        std::error_code unknown;
        if (code != ENXIO || !fs::is_fifo(target_, unknown))
            fail(code);
        ::poll(nullptr, 0, moment_ms);
        if (!should_continue())
            return;
    }
}

bool output_file::should_continue()
{
    given_up_ = given_up_ || (go_on_ && !go_on_());
    return !given_up_;
}

bool output_file::wait_for_room()
{
    pollfd p{.fd = fd_.get(), .events = POLLOUT, .revents = 0};
    while (::poll(&p, 1, moment_ms) == 0)
        if (!should_continue())
            return false;
    return true;
}

// Opens a temporary file and gives it the owner, group and permissions of the file that it will replace. Only
// root can change the owner; for others, tries the group alone. Sets the owner first, since this may remove
// permissions.
void output_file::open_temporary()
{
    constexpr mode_t rights = 0777;
    const std::string stem = target_.filename().string().substr(0, longest_stem);
    std::random_device seed;
    int code = EEXIST;
    for (int i = 0; i < attempts && code == EEXIST; ++i) {
        temporary_ = parent_folder(target_) / fmt::format(".{}.{:08x}.part", stem, seed());
        fd_ = owned_fd(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
        code = fd_ ? 0 : errno;
    }
    if (code != 0) {
        temporary_.clear();
        fail(code);
    }
    struct stat old {};
    if (::stat(target_.c_str(), &old) != 0)
        return;
    struct stat ours {};
    if (::fstat(fd_.get(), &ours) == 0 && (ours.st_uid != old.st_uid || ours.st_gid != old.st_gid) &&
        ::fchown(fd_.get(), old.st_uid, old.st_gid) != 0 && ::fchown(fd_.get(), uid_t(-1), old.st_gid) != 0) {
        // The new file has another group: give this group only the permissions that all users have.
        old.st_mode &= ~mode_t{S_IRWXG} | ((old.st_mode & S_IRWXO) << 3U);
    }
    (void)::fchmod(fd_.get(), old.st_mode & rights);
}

output_file::~output_file()
{
    if (!temporary_.empty())
        ::unlink(temporary_.c_str());
}

void output_file::fail(int code) const
{
    const std::string why = std::error_code(code, std::generic_category()).message();
    std::string_view hint = "check the folder's rights and space";
    if (code == ENOSPC || code == EDQUOT) {
        hint = directly_ ? "free some space, or write to another disk; the output is incomplete"
                         : "free some space, or name a file on another disk; nothing was left behind";
    } else if (code == EPIPE) {
        hint = "let the program that reads the output run to the end";
    } else if (code == EBADF) {
        hint = "send the output to a file or a pipe, or name a file";
    } else if (code == EFBIG) {
        hint = "use another file system or raise ulimit -f: the file is too large";
    } else if (code == EACCES || code == EPERM || code == EROFS) {
        hint = "name a file that you may write";
    }
    throw_with_cause(error(error_kind::runtime, source_place{name_.string()},
                           fmt::format("it cannot be written: {}", why), hint),
                     code);
}

std::int64_t output_file::write(const void* data, std::int64_t bytes)
{
    const auto* from = static_cast<const char*>(data);
    std::int64_t done = 0;
    // A pipe that has space accepts PIPE_BUF bytes without blocking.
    while (done < bytes && good() && (!directly_ || wait_for_room())) {
        const std::int64_t now = directly_ ? std::min<std::int64_t>(bytes - done, PIPE_BUF) : bytes - done;
        const ssize_t n = ::write(fd_.get(), from + done, static_cast<std::size_t>(now));
        if (n > 0)
            done += n;
        else if (n == 0 || (errno != EINTR && errno != EAGAIN))
            failure_ = n == 0 ? ENOSPC : errno;
    }
    return done;
}

void output_file::commit()
{
    if (failure_ != 0)
        fail(failure_);
    if (given_up_)
        fail(ECANCELED);
    // Without fsync(), a power cut could leave an empty file with this name.
    if (!temporary_.empty() && ::fsync(fd_.get()) != 0)
        fail(errno);
    // A network file system may report a full disk only now.
    if (fd_.close() != 0 && errno != EINTR)
        fail(errno);
    if (temporary_.empty())
        return;
    if (::rename(temporary_.c_str(), target_.c_str()) != 0)
        fail(errno);
    temporary_.clear();
    sync_folder(parent_folder(target_));
}

void write_file(const std::filesystem::path& file, std::string_view bytes, owner_kind writer)
{
    output_file out(file, {}, writer);
    out.write(bytes.data(), static_cast<std::int64_t>(bytes.size()));
    out.commit();
}

} // namespace tactor::detail
