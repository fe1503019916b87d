// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plot/output.hpp"

namespace tactor::plot {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, int code)
{
    std::string_view hint = "check the folder's rights and space";
    if (code == ENOSPC || code == EDQUOT)
        hint = "free some space, or name a file on another disk; nothing was left behind";
    else if (code == EACCES || code == EPERM || code == EROFS)
        hint = "name a file where you may write";
    throw error(
        errc::runtime, file.string(),
        fmt::format("cannot be written: {}", std::error_code(code, std::generic_category()).message()), hint);
}

// The file that a chain of links names: the link stays and what it points to is replaced.
fs::path follow_links(fs::path p)
{
    std::error_code ignored;
    for (int i = 0; i < 40 && fs::is_symlink(p, ignored); ++i) {
        const fs::path next = fs::read_symlink(p, ignored);
        p = next.is_absolute() ? next : p.parent_path() / next;
    }
    return p;
}

// Returns errno, or 0.
int write_all(int fd, const std::string& bytes) noexcept
{
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return n < 0 ? errno : ENOSPC;
        done += static_cast<std::size_t>(n);
    }
    return 0;
}

int close_after(int fd, int code) noexcept
{
    // A network file system may tell of a full disk only now.
    const int closed = ::close(fd) == 0 || errno == EINTR ? 0 : errno;
    return code != 0 ? code : closed;
}

void write_directly(const fs::path& asked, const fs::path& target, const std::string& bytes)
{
    const int fd = ::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd < 0)
        fail(asked, errno);
    if (const int code = close_after(fd, write_all(fd, bytes)))
        fail(asked, code);
}

void replace(const fs::path& asked, const fs::path& target, const std::string& bytes)
{
    constexpr std::size_t longest_stem = 200; // room for the suffix within the 255 bytes of a name
    const fs::path folder = target.parent_path().empty() ? "." : target.parent_path();
    std::string name =
        (folder / fmt::format(".{}.XXXXXX", target.filename().string().substr(0, longest_stem))).string();
    const int fd = ::mkstemp(name.data());
    if (fd < 0)
        fail(asked, errno);
    const mode_t mask = ::umask(0);
    ::umask(mask);
    int code = write_all(fd, bytes);
    if (code == 0 && ::fchmod(fd, 0666U & ~mask) != 0)
        code = errno;
    code = close_after(fd, code);
    if (code == 0 && ::rename(name.c_str(), target.c_str()) != 0)
        code = errno;
    if (code != 0) {
        ::unlink(name.c_str());
        fail(asked, code);
    }
}

} // namespace

file_format format_of(const fs::path& file)
{
    std::string e = file.extension().string();
    std::transform(e.begin(), e.end(), e.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (e == ".svg")
        return file_format::svg;
    if (e == ".png")
        return file_format::png;
    if (e == ".pdf")
        return file_format::pdf;
    throw error(errc::bad_input, file.string(),
                e.empty() ? "has no extension" : fmt::format("\"{}\" is no format for a picture", e),
                "end the name in .svg, .png or .pdf");
}

void save(const canvas& c, const fs::path& file, unsigned dpi)
{
    const file_format format = format_of(file);
    const fs::path target = follow_links(file);
    std::error_code ignored;
    const fs::file_status there = fs::status(target, ignored);
    const fs::path folder = target.parent_path().empty() ? "." : target.parent_path();
    if (fs::is_directory(there))
        throw error(errc::bad_input, file.string(), "is a folder", "name a file in it");
    if (!fs::is_directory(folder, ignored))
        throw error(errc::bad_input, file.string(),
                    fmt::format("the folder \"{}\" does not exist", folder.string()),
                    "make it first, or name another");
    if (fs::exists(there) && ::access(target.c_str(), W_OK) != 0)
        fail(file, errno);
    const std::string bytes = format == file_format::svg   ? to_svg(c)
                              : format == file_format::png ? to_png(c, dpi)
                                                           : to_pdf(c);
    if (fs::exists(there) && !fs::is_regular_file(there))
        write_directly(file, target, bytes);
    else
        replace(file, target, bytes);
}

} // namespace tactor::plot
