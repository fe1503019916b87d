// SPDX-License-Identifier: MIT
#include "session/pipes.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "core/owned.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

namespace fs = std::filesystem;

// A pipe of the shell's, <(...) or /dev/stdin, has its other end already.
bool is_named_pipe(const std::string& file)
{
    std::error_code ignored;
    return fs::is_fifo(fs::symlink_status(file, ignored));
}

bool is_descriptor(const struct stat& s, int fd)
{
    struct stat out {};
    return ::fstat(fd, &out) == 0 && out.st_dev == s.st_dev && out.st_ino == s.st_ino;
}

// A folder has no text. A terminal, or a pipe that this process writes to, would be read for ever; a file
// would grow by what is made of it.
void refuse_unreadable(const std::string& file)
{
    struct stat s {};
    if (::stat(file.c_str(), &s) != 0)
        return;
    if (S_ISDIR(s.st_mode))
        throw error(error_kind::bad_input, source_place{file}, "is a folder", "name a file in it")
            .with_os_code(EISDIR);
    if ((S_ISFIFO(s.st_mode) || S_ISREG(s.st_mode)) &&
        (is_descriptor(s, STDOUT_FILENO) || is_descriptor(s, STDERR_FILENO)))
        throw error(error_kind::bad_input, file, "is where this program writes to",
                    "name a file to read, or - for standard input");
    if (!S_ISCHR(s.st_mode))
        return;
    const detail::owned_fd fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (fd && ::isatty(fd.get()) == 1)
        throw error(error_kind::bad_input, file, "is a terminal", "name a file to read");
}

} // namespace

void check_readable(const std::string& file)
{
    refuse_unreadable(file);
    if (is_named_pipe(file))
        say(stderr, "tactor: {}: is a pipe: waiting for a program that writes to it (Ctrl-C ends)\n", file);
}

bool is_standard_output(const std::string& file)
{
    struct stat s {};
    return ::stat(file.c_str(), &s) == 0 && is_descriptor(s, STDOUT_FILENO);
}

void refuse_standard_input(int code)
{
    const bool wrong = code == EBADF || code == EISDIR;
    throw error(wrong ? error_kind::bad_input : error_kind::runtime, "standard input",
                std::generic_category().message(code), "give lines from a terminal, a file or a pipe")
        .with_os_code(code);
}

void check_standard_input()
{
    char none = 0;
    if (::read(STDIN_FILENO, &none, 0) < 0)
        refuse_standard_input(errno);
}

void tell_of_pipe_to_write(const std::string& file)
{
    if (is_named_pipe(file))
        say(stderr, "tactor: {}: is a pipe: waiting for a program that reads it (Ctrl-C ends)\n", file);
}

} // namespace tactor::session
