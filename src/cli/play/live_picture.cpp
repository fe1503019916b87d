// SPDX-License-Identifier: MIT
#include "cli/play/live_picture.hpp"

#include <cerrno>
#include <new>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/say.hpp"
#include "core/words.hpp"
#include "rt/variable.hpp"

namespace tactor::cli {
namespace {

// Time for a slow terminal. One that takes nothing blocks the next printed line anyway.
constexpr int patience_ms = 2000;

std::string to_its_beginning(std::size_t lines)
{
    return lines == 0 ? "\r" : fmt::format("\r\033[{}A", lines);
}

volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int) noexcept
{
    stop_asked = 1;
}

// Returns true in the background. A terminal that does not control this process has no foreground group.
bool is_in_background() noexcept
{
    const pid_t front = ::tcgetpgrp(STDOUT_FILENO);
    return front >= 0 && front != ::getpgrp();
}

} // namespace

bool can_draw()
{
    const std::string kind = rt::variable("TERM");
    return isatty(STDOUT_FILENO) != 0 && !kind.empty() && kind != "dumb";
}

bool may_colour()
{
    return rt::variable("NO_COLOR").empty();
}

// Reads the environment: the program itself stays in the C locale.
bool speaks_utf8()
{
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        const std::string value = in_small_letters(rt::variable(name));
        if (value.empty())
            continue;
        return value.find("utf-8") != std::string::npos || value.find("utf8") != std::string::npos;
    }
    return false;
}

// Opens standard output again: O_NONBLOCK on it would hold for all processes that share it, such as the
// shell.
terminal::terminal() : fd_(open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC))
{
    if (fd_ < 0) // no /proc: writes may block
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
            left_.clear(); // hung up
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

live_picture::live_picture(const array& a, bool wanted) : array_(a), style_{speaks_utf8(), may_colour()}
{
    flush_output(); // printed lines stay above it
    if (!wanted || !can_draw())
        return;
    terminal_.emplace();
    struct sigaction ask = {};
    ask.sa_handler = ask_to_stop;
    ask.sa_flags = SA_RESTART;
    ::sigaction(SIGTSTP, &ask, &before_);
}

live_picture::~live_picture()
{
    if (!terminal_)
        return;
    ::sigaction(SIGTSTP, &before_, nullptr);
    try {
        erase();
    } catch (const std::bad_alloc&) { // then the picture stays
    }
    if (stop_asked == 0)
        return;
    stop_asked = 0;
    std::raise(SIGTSTP);
}

void live_picture::erase()
{
    const std::size_t lines = std::exchange(drawn_lines_, 0);
    if (lines == 0)
        return;
    terminal_->write(to_its_beginning(lines) + "\033[J");
    terminal_->finish();
}

// Erases the picture and stops, if asked: the shell's prompt takes its place.
void live_picture::stop_where_asked()
{
    if (stop_asked == 0)
        return;
    erase();
    stop_asked = 0;
    std::raise(SIGSTOP);
}

void live_picture::draw(const instant& now, double t_s, double total_s)
{
    if (!terminal_)
        return;
    stop_where_asked();
    if (is_in_background() || !terminal_->idle())
        return;
    const auto lines = picture_lines(array_, now, t_s, total_s, terminal_->size(), style_);
    std::string text = to_its_beginning(drawn_lines_);
    for (const std::string& line : lines)
        text += line + "\033[K\n";
    terminal_->write(std::move(text) + "\033[J");
    drawn_lines_ = lines.size();
}

stroke_report play_drawn(session::play_session& session, const array& a, const piece& p, const score& s,
                         bool wanted, const std::function<void()>& armed)
{
    if (const auto ended = session.submit(s))
        return *ended;
    armed();
    live_picture picture(a, wanted);
    if (!picture.active())
        return session.follow();
    piece_follower follower(p, s, a);
    const double total_s = static_cast<double>(s.frames()) / s.rate();
    double t_s = 0.0; // keeps its value until the report of the stroke's end arrives
    return session.follow([&] {
        if (const auto frame = session.stroke_frame())
            t_s = static_cast<double>(*frame) / s.rate();
        picture.draw(follower.at(t_s), t_s, total_s);
        return session::look{.most_ms = session::frame_ms};
    });
}

} // namespace tactor::cli
