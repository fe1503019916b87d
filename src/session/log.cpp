// SPDX-License-Identifier: MIT
#include "session/log.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "files/text_file.hpp"
#include "rt/clock.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

std::string time_text(std::int64_t at_ns)
{
    const std::time_t s = at_ns / rt::ns_per_s;
    std::tm t{};
    gmtime_r(&s, &t);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", t.tm_year + 1900, t.tm_mon + 1,
                       t.tm_mday, t.tm_hour, t.tm_min, t.tm_sec, at_ns % rt::ns_per_s / 1'000'000);
}

// Returns true if a text begins like a line of this log.
bool is_log(std::string_view text)
{
    constexpr std::string_view form = "dddd-dd-ddTdd:dd:dd.dddZ ";
    if (text.size() < form.size())
        return false;
    for (std::size_t i = 0; i < form.size(); ++i)
        if (form[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != form[i])
            return false;
    return true;
}

// Returns true for an empty file or a log: lines must not be appended to an array file that was named by
// mistake.
bool is_appendable(int fd)
{
    std::array<char, 32> begin{};
    const ssize_t n = ::pread(fd, begin.data(), begin.size(), 0);
    return n == 0 || (n > 0 && is_log({begin.data(), static_cast<std::size_t>(n)}));
}

// Removes a line that was written only in part, unless another process has written since. Otherwise the next
// log would continue that line.
void take_back(int fd, ssize_t written)
{
    const off_t end = ::lseek(fd, 0, SEEK_CUR);
    struct stat s {};
    if (end < written || ::fstat(fd, &s) != 0 || s.st_size != end)
        return;
    [[maybe_unused]] const int ignored = ::ftruncate(fd, end - written);
}

} // namespace

std::string stroke_text(std::string_view name, const stroke_report& r, unsigned rate)
{
    const std::string began = r.started_ns
                                  ? fmt::format("began {} ({:.6f} s by CLOCK_MONOTONIC)",
                                                time_text(rt::unix_ns() - rt::monotonic_ns() + *r.started_ns),
                                                static_cast<double>(*r.started_ns) * 1e-9)
                                  : "did not begin";
    return fmt::format("stroke {}: {}, {} after {:.3f} s{}{}", name, began, to_string(r.state),
                       static_cast<double>(r.frames) / rate, r.why.empty() ? "" : ": ", r.why);
}

session_log::session_log(bool verbose, std::string file) : verbose_(verbose), file_(std::move(file))
{
    if (!file_.empty())
        open();
}

void session_log::open()
{
    // Follows no link, and does not wait for a pipe.
    fd_ = detail::owned_fd(
        ::open(file_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    const int code = errno;
    struct stat s {};
    if (!fd_ && code == ELOOP)
        throw error(error_kind::bad_input, file_, "it is a link",
                    "name the file itself, or use {verbose=true} to log to standard error");
    if (!fd_ && code == EISDIR)
        throw error(error_kind::bad_input, file_, "it is a folder", "name a file in it");
    if (!fd_)
        throw error(code == ENOENT || code == ENOTDIR ? error_kind::bad_input : error_kind::runtime, file_,
                    std::strerror(code),
                    code == ENOENT ? "create its folder first"
                                   : "name a file in a folder that you can write");
    if (::fstat(fd_.get(), &s) != 0 || !S_ISREG(s.st_mode))
        throw error(error_kind::bad_input, file_, "it is not a regular file",
                    "name a regular file, or use {verbose=true} to log to standard error");
    detail::refuse_input(s, file_);
    if (!is_appendable(fd_.get()))
        throw error(error_kind::bad_input, file_, "it exists and is not a log",
                    "choose another name: tactor appends only to logs");
}

log_function session_log::function()
{
    if (!verbose_ && !fd_)
        return {};
    return [this](log_kind k, std::string_view text) { write(k, text); };
}

void session_log::write(log_kind k, std::string_view text)
{
    const std::string line =
        fmt::format("{} {} {}\n", time_text(rt::unix_ns()), to_string(k), make_printable(text));
    if (verbose_)
        say_text(stderr, goes_to_journal(stderr) ? make_printable(text) + "\n" : line, k);
    if (!fd_)
        return;
    const ssize_t n = ::write(fd_.get(), line.data(), line.size());
    if (n == static_cast<ssize_t>(line.size()))
        return;
    const int code = n < 0 ? errno : ENOSPC;
    if (n > 0)
        take_back(fd_.get(), n);
    // The stroke continues: a log that ends early is not a reason to stop it.
    say(stderr, "tactor: warning: {}: {}: the log ends here\n", make_printable(file_), std::strerror(code));
    fd_.close();
}

} // namespace tactor::session
