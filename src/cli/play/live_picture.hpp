// SPDX-License-Identifier: MIT
/// \file
/// The array in characters on a terminal while it plays.
#pragma once

#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "session/play_session.hpp"
#include "synth/score/sounding_now.hpp"

namespace tactor::cli {

/// State of a piece at one time.
struct instant {
    std::vector<double> levels;  ///< per tactor, linear, 1 is the intensity asked for
    std::optional<point> target; ///< where the touch is
};

/// Follows a piece from its beginning on.
class piece_follower {
public:
    /// `p` must live as long.
    piece_follower(const piece& p, const score& s, const array& a);

    /// Times, in seconds from the start of the piece, are to ascend: what is over is not found again.
    instant at(double t_s);

private:
    const piece& piece_;
    score score_;
    layout faces_;
    synth::sounding_now sounding_;
};

struct terminal_size {
    unsigned columns = 80;
    unsigned rows = 24;

    friend bool operator==(const terminal_size&, const terminal_size&) = default;
};

struct picture_style {
    bool unicode = true; ///< shades, not letters
    bool colours = true;
};

/// The array with each tactor's level and the place of the touch, and under it time, place and progress: at
/// most rows - 1 lines of columns - 1 characters, so that nothing wraps or scrolls. Where there is less space
/// the array is drawn smaller, then left out, and then what the last line says.
std::vector<std::string> picture_lines(const array& a, const instant& now, double t_s, double total_s,
                                       terminal_size size, picture_style style);

/// Returns true if standard output is a terminal on which lines can be drawn again.
bool can_draw();

/// Returns true unless NO_COLOR asks for no colours (no-color.org: set, and not empty).
bool may_colour();

/// Whether the locale's characters are UTF-8.
bool speaks_utf8();

/// Writes to the terminal without ever waiting for it: one that was stopped (Ctrl-S), or is slow, must not
/// keep a signal from ending the program.
class terminal {
public:
    terminal();
    ~terminal();
    terminal(const terminal&) = delete;
    terminal& operator=(const terminal&) = delete;

    /// As it is now; people resize windows.
    terminal_size size() const noexcept;

    /// Whether all that was given to write() has been taken.
    bool idle();
    void write(std::string text);
    /// Waits a little for what is left.
    void finish();

private:
    int fd_;
    std::string left_;
};

/// Draws over itself, and takes itself away when destroyed and before Ctrl-Z stops the program. In the
/// background it draws nothing. It changes no mode of the terminal (the cursor
/// stays visible), so that there is nothing to restore whatever ends the program. Where standard output is no
/// terminal, it draws nothing.
class live_picture {
public:
    explicit live_picture(const array& a, bool wanted = true);
    ~live_picture();
    live_picture(const live_picture&) = delete;
    live_picture& operator=(const live_picture&) = delete;

    bool active() const noexcept { return terminal_.has_value(); }
    /// Skipped while the terminal has not taken what was drawn before.
    void draw(const instant& now, double t_s, double total_s);

private:
    void erase();
    void stop_where_asked();

    const array& array_;
    std::optional<terminal> terminal_ = {};
    picture_style style_;
    std::size_t drawn_lines_ = 0;
    struct sigaction before_ = {}; ///< what SIGTSTP did
};

/// Plays a score of a piece to its end, and draws it on a terminal where that is `wanted`. With
/// stream_options::arm `armed` is called once the score waits for its trigger. \throws error.
stroke_report play_drawn(
    session::play_session& session, const array& a, const piece& p, const score& s, bool wanted,
    const std::function<void()>& armed = [] {});

} // namespace tactor::cli
