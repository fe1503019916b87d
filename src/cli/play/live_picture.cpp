// SPDX-License-Identifier: MIT
#include "cli/play/play.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "cli/say.hpp"
#include "core/owned.hpp"
#include "core/words.hpp"
#include "rt/system_files.hpp"
#include "session/walk.hpp"
#include "synth/score/score_view.hpp"

namespace tactor::cli {

struct picture_style {
    bool unicode = true; // true for shades, false for letters
    bool colours = true; // false if NO_COLOR is set and not empty (no-color.org)
};

namespace {

constexpr unsigned margin = 3;              // columns left of the array
constexpr double natural_mm = 1.25;         // width of a column if there is space: 4 columns are 5 mm
constexpr unsigned least_array_columns = 5; // with fewer, nothing can be seen
// Colours that are legible on black and on white. Magenta has a contrast of 4.5 : 1 and 4.7 : 1. Reversed
// letters have the same contrast as the terminal's normal text.
constexpr const char* level_colour = "\033[35m";
constexpr const char* target_colour = "\033[7m";
constexpr const char* no_colour = "\033[0m";

// Returns the level of a tactor as a shade. Shades are easier to see than changing digits.
const char* shade(double level, bool unicode)
{
    static constexpr std::array shades{"·", "░", "▒", "▓", "█"};
    static constexpr std::array letters{".", ":", "+", "x", "#"};
    const auto i = static_cast<std::size_t>(std::clamp(std::ceil(level * 4.0), 0.0, 4.0));
    return unicode ? shades[i] : letters[i];
}

struct terminal_size {
    unsigned columns = 80;
    unsigned rows = 24;
};

// A grid of characters. A character is about twice as high as it is wide.
class grid {
public:
    grid(const detail::box& b, unsigned columns, unsigned rows) : low_(b.low)
    {
        const double wide = b.high.x_mm - b.low.x_mm;
        const double tall = b.high.y_mm - b.low.y_mm;
        // A tactor takes three cells in a row, which makes its level visible.
        mm_ = std::max({natural_mm, wide / (columns - 3), rows > 1 ? tall / (2.0 * (rows - 1)) : 0.0});
        columns_ = static_cast<unsigned>(std::lround(wide / mm_)) + 3;
        rows_ = static_cast<unsigned>(std::lround(tall / (2.0 * mm_))) + 1;
        levels_.assign(std::size_t{columns_} * rows_, -1.0);
    }

    void put_tactor(point p, double level)
    {
        const std::size_t at = find_cell(p);
        // In a small picture, several tactors may share a cell. The cell shows the strongest level.
        for (std::size_t i = at; i < at + 3; ++i)
            levels_[i] = std::max(levels_[i], level);
    }

    void put_target(point p) { targets_.push_back(find_cell(p) + 1); }

    std::vector<std::string> lines(picture_style style) const
    {
        std::vector<std::string> all;
        for (unsigned r = 0; r < rows_; ++r) {
            std::string line(margin, ' ');
            for (std::size_t i = std::size_t{r} * columns_; i < std::size_t{r + 1} * columns_; ++i)
                line += cell_text(i, style);
            line.erase(line.find_last_not_of(' ') + 1);
            all.push_back(line);
        }
        return all;
    }

private:
    std::size_t find_cell(point p) const
    {
        const auto whole = [](double v, unsigned most) {
            return static_cast<unsigned>(std::clamp(std::round(v), 0.0, static_cast<double>(most)));
        };
        return std::size_t{whole((p.y_mm - low_.y_mm) / (2.0 * mm_), rows_ - 1)} * columns_ +
               whole((p.x_mm - low_.x_mm) / mm_, columns_ - 3);
    }

    std::string cell_text(std::size_t i, picture_style style) const
    {
        const auto coloured = [&](const char* colour, const char* text) {
            return style.colours ? fmt::format("{}{}{}", colour, text, no_colour) : text;
        };
        if (std::ranges::count(targets_, i) != 0)
            return coloured(target_colour, "o");
        if (levels_[i] > 0.0)
            return coloured(level_colour, shade(levels_[i], style.unicode));
        return levels_[i] == 0.0 ? shade(0.0, style.unicode) : " ";
    }

    point low_;
    double mm_;
    unsigned columns_;
    unsigned rows_;
    std::vector<double> levels_;            // by cell; a negative value means that there is no tactor
    std::vector<std::size_t> targets_ = {}; // cells with a target
};

// Returns the longest status line that fits in `columns`.
std::string status_line(const instant& now, double t_s, double total_s, unsigned columns)
{
    const double t = std::max(t_s, 0.0);
    const std::string time = fmt::format("{:.2f} s", t);
    const std::string times = fmt::format("{:.2f} / {:.2f} s", t, total_s);
    std::string place;
    if (now.targets.size() == 1)
        place = fmt::format("   at {:.1f}, {:.1f} mm", now.targets[0].x_mm, now.targets[0].y_mm);
    // Reserves space for a place with this many characters, so that the bar does not change its length.
    const std::size_t beside = times.size() + std::string_view("   at -000.0, -000.0 mm").size() + margin + 3;
    if (columns >= beside + 10) {
        const std::size_t length = std::min<std::size_t>(30, columns - beside);
        const double share = std::clamp(t / std::max(total_s, 1e-9), 0.0, 1.0);
        const auto done = static_cast<std::size_t>(share * static_cast<double>(length));
        const std::string bar = std::string(done, '=') + std::string(length - done, ' ');
        return fmt::format("{}[{}] {}{}", std::string(margin, ' '), bar, times, place);
    }
    for (const std::string& line : {times + place, times, time})
        if (line.size() <= columns)
            return line;
    return {};
}

// Returns the lines of the picture: the array with the level of each tactor and the place of the touch, and
// below it the time, the place and the progress. There are at most rows - 1 lines of columns - 1 characters,
// so that nothing wraps or scrolls. If there is less space, the array is smaller or left out, and then the
// status line becomes shorter.
std::vector<std::string> picture_lines(const array& a, const instant& now, double t_s, double total_s,
                                       terminal_size size, picture_style style)
{
    if (size.columns < 2 || size.rows < 2)
        return {};
    const unsigned columns = size.columns - 1;
    const unsigned rows = size.rows - 1;
    const unsigned gap = rows >= 6 ? 1 : 0; // lines between the array and the status line
    const detail::box b = session::find_bounds(a);
    // An array with several rows needs more than one line, because a single line would show touches at wrong
    // places.
    const unsigned least_rows = b.high.y_mm - b.low.y_mm > natural_mm ? 2 : 1;

    std::vector<std::string> lines;
    if (columns >= margin + least_array_columns && rows >= least_rows + gap + 1) {
        grid g(b, columns - margin, rows - gap - 1);
        for (std::size_t i = 0; i < a.tactors.size(); ++i)
            g.put_tactor(a.tactors[i].position, now.levels[i]);
        for (const point& p : now.targets)
            g.put_target(p);
        lines = g.lines(style);
        lines.resize(lines.size() + gap);
    }
    lines.push_back(status_line(now, t_s, total_s, columns));
    return lines;
}

// Returns the places of the touches at a time of the piece, s. Returns none between two strokes.
std::vector<point> find_targets(const piece& p, const score& s, const layout& faces, double t_s)
{
    std::vector<point> all;
    for (std::size_t i = 0; i < std::min(p.strokes.size(), s.plans().size()); ++i) {
        const double t = t_s - static_cast<double>(s.starts()[i]) / s.rate();
        if (t < 0.0 || t > s.plans()[i].plan.total_s)
            continue;
        all.push_back(faces.nearest(p.strokes[i].motion.position(t)));
    }
    return all;
}

// Returns true if the locale in the environment uses UTF-8. The program itself stays in the C locale.
bool is_utf8_locale()
{
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        const std::string value = to_lower_case(rt::variable(name));
        if (value.empty())
            continue;
        return value.find("utf-8") != std::string::npos || value.find("utf8") != std::string::npos;
    }
    return false;
}

std::string cursor_up_code(std::size_t lines)
{
    return lines == 0 ? "\r" : fmt::format("\r\033[{}A", lines);
}

volatile std::sig_atomic_t stop_asked = 0;

void record_stop_request(int) noexcept
{
    stop_asked = 1;
}

// Returns true if this process is in the background. A terminal that is not the controlling terminal has no
// foreground group.
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

// Writer that never waits for the terminal. If the terminal is stopped (Ctrl-S) or slow, a signal must still
// be able to end the program.
class terminal {
public:
    const picture_style style{is_utf8_locale(), rt::variable("NO_COLOR").empty()};

    // Returns the current size of the window.
    static terminal_size size() noexcept
    {
        winsize w{};
        if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) != 0 || w.ws_col == 0 || w.ws_row == 0)
            return {};
        return {w.ws_col, w.ws_row};
    }

    // Writes the rest of earlier texts. Returns true if the terminal has accepted everything.
    bool write_rest()
    {
        while (!left_.empty()) {
            const ssize_t n = ::write(file_.get(), left_.data(), left_.size());
            if (n < 0 && errno == EINTR)
                continue;
            if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
                return false;
            if (n < 0)
                left_.clear(); // the terminal is closed
            else
                left_.erase(0, static_cast<std::size_t>(n));
        }
        return true;
    }

    // Writes as much of the text as the terminal accepts, and keeps the rest for later.
    void write(const std::string& text)
    {
        left_ += text;
        write_rest();
    }

    // Waits up to two seconds for the terminal to accept the rest. If it accepts nothing, the next printed
    // line will block anyway.
    void finish()
    {
        for (int tries = 10; !write_rest() && tries > 0; --tries) {
            pollfd p{.fd = file_.get(), .events = POLLOUT, .revents = 0};
            ::poll(&p, 1, 200);
        }
    }

private:
    // Standard output, opened a second time. Setting O_NONBLOCK on the shared descriptor would also affect
    // other processes, such as the shell.
    detail::owned_fd file_{open("/proc/self/fd/1", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
    std::string left_;
};

live_picture::live_picture(const array& a) : array_(a)
{
    flush_output(); // lines printed earlier stay above the picture
    if (!can_draw())
        return;
    terminal_ = std::make_unique<terminal>();
    struct sigaction ask = {};
    ask.sa_handler = record_stop_request;
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
    } catch (const std::bad_alloc&) { // the picture stays visible
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
    terminal_->write(cursor_up_code(lines) + "\033[J");
    terminal_->finish();
}

// Erases the picture and stops the program if Ctrl-Z was pressed. The shell's prompt then appears in place of
// the picture.
void live_picture::handle_stop_request()
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
    handle_stop_request();
    if (is_in_background() || !terminal_->write_rest())
        return;
    const auto lines = picture_lines(array_, now, t_s, total_s, terminal::size(), terminal_->style);
    std::string text = cursor_up_code(drawn_lines_);
    for (const std::string& line : lines)
        text += line + "\033[K\n";
    terminal_->write(text + "\033[J");
    drawn_lines_ = lines.size();
}

stroke_report follow_and_draw(session::play_session& session, const array& a, const piece& p, const score& s,
                              bool wanted)
{
    if (!wanted || !can_draw())
        return session.follow();
    live_picture picture(a);
    synth::sounding_now sounding(s);
    const layout faces(a);
    const double total_s = static_cast<double>(s.frames()) / s.rate();
    std::uint64_t frame = 0; // unchanged until the report of the stroke's end arrives
    return session.follow([&] {
        frame = session.stroke_frame().value_or(frame);
        const double t_s = static_cast<double>(frame) / s.rate();
        picture.draw({sounding.at(frame), find_targets(p, s, faces, t_s)}, t_s, total_s);
        return session::look{.most_ms = session::frame_ms};
    });
}

} // namespace tactor::cli
