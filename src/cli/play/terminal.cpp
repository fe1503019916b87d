// SPDX-License-Identifier: MIT
#include "cli/play/terminal.hpp"

#include <cerrno>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/words.hpp"
#include "session/variable.hpp"

namespace tactor::cli {
namespace {

// For whoever reads slowly. A terminal that takes nothing holds up the line that is printed next, anyway.
constexpr int patience_ms = 2000;

} // namespace

bool can_draw()
{
    const std::string kind = session::variable("TERM");
    return isatty(STDOUT_FILENO) != 0 && !kind.empty() && kind != "dumb";
}

bool may_colour()
{
    return session::variable("NO_COLOR").empty();
}

// From the environment: the program itself stays in the C locale, whatever it is called in.
bool speaks_utf8()
{
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        const std::string value = in_small_letters(session::variable(name));
        if (value.empty())
            continue;
        return value.find("utf-8") != std::string::npos || value.find("utf8") != std::string::npos;
    }
    return false;
}

// Opened anew: O_NONBLOCK on standard output itself would be there for all who share it, the shell included.
terminal::terminal() : fd_(open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC))
{
    if (fd_ < 0) // no /proc: waiting is better than nothing
        fd_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
}

terminal::~terminal()
{
    if (fd_ >= 0)
        close(fd_);
}

terminal_size terminal::size() const noexcept
{
    winsize w{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) != 0 || w.ws_col == 0 || w.ws_row == 0)
        return {};
    return {w.ws_col, w.ws_row};
}

bool terminal::idle()
{
    while (!left_.empty()) {
        const ssize_t n = ::write(fd_, left_.data(), left_.size());
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            return false;
        if (n < 0)
            left_.clear(); // hung up: nobody looks any more
        else
            left_.erase(0, static_cast<std::size_t>(n));
    }
    return true;
}

void terminal::write(std::string text)
{
    left_ += text;
    idle();
}

void terminal::finish()
{
    for (int waited = 0; !idle() && waited < patience_ms; waited += patience_ms / 10) {
        pollfd p{.fd = fd_, .events = POLLOUT, .revents = 0};
        ::poll(&p, 1, patience_ms / 10);
    }
}

} // namespace tactor::cli
