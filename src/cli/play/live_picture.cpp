// SPDX-License-Identifier: MIT
#include "cli/play/live_picture.hpp"

#include <new>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/say.hpp"

namespace tactor::cli {
namespace {

std::string to_its_beginning(std::size_t lines)
{
    return lines == 0 ? "\r" : fmt::format("\r\033[{}A", lines);
}

volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int) noexcept
{
    stop_asked = 1;
}

// A terminal that does not control this process tells no foreground group.
bool is_in_background() noexcept
{
    const pid_t front = ::tcgetpgrp(STDOUT_FILENO);
    return front >= 0 && front != ::getpgrp();
}

} // namespace

live_picture::live_picture(const array& a, bool wanted) : array_(a), style_{speaks_utf8(), may_colour()}
{
    flush_output(); // what was printed before stands above it
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
    } catch (const std::bad_alloc&) { // then it stays
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

// The shell's prompt comes where the picture was.
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
    double t_s = 0.0; // stays where it was while the report of the stroke's end is on its way
    return session.follow([&] {
        if (const auto frame = session.stroke_frame())
            t_s = static_cast<double>(*frame) / s.rate();
        picture.draw(follower.at(t_s), t_s, total_s);
        return session::look{.most_ms = session::frame_ms};
    });
}

} // namespace tactor::cli
