// SPDX-License-Identifier: MIT
/// \file
/// The array in characters on a terminal while it plays.
#pragma once

#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "core/owned.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

/// State of a piece at one time.
struct instant {
    std::vector<double> levels;  ///< by tactor, linear; 1: the intensity of the stroke
    std::optional<point> target; ///< place of the touch
};

struct terminal_size {
    unsigned columns = 80;
    unsigned rows = 24;
};

struct picture_style {
    bool unicode = true; ///< true: shades, false: letters
    bool colours = true; ///< false: NO_COLOR is set and not empty (no-color.org)
};

/// Returns true if standard output is a terminal on which lines can be drawn again.
bool can_draw();

/// Writer to the terminal that never waits for it: a terminal that is stopped (Ctrl-S) or slow must not keep
/// a signal from ending the program.
class terminal {
public:
    terminal();

    /// Returns the size as it is now: windows change.
    terminal_size size() const noexcept;

    /// Returns true if the terminal has taken all that was given to write().
    bool idle();
    /// Writes as much as the terminal takes; keeps the rest.
    void write(std::string text);
    /// Waits up to two seconds for the rest.
    void finish();

private:
    detail::owned_fd file_;
    std::string left_;
};

/// Picture that draws over itself, and erases itself when destroyed and before Ctrl-Z stops the program.
/// Draws nothing in the background, and if standard output is no terminal. Changes no mode of the terminal
/// (the cursor stays visible), so that nothing has to be restored, however the program ends.
class live_picture {
public:
    explicit live_picture(const array& a, bool wanted = true);
    ~live_picture();
    live_picture(const live_picture&) = delete;
    live_picture& operator=(const live_picture&) = delete;

    bool active() const noexcept { return terminal_.has_value(); }
    /// Draws, unless the terminal has not taken the previous picture yet.
    void draw(const instant& now, double t_s, double total_s);

private:
    void erase();
    void stop_where_asked();

    const array& array_;
    std::optional<terminal> terminal_ = {};
    picture_style style_;
    std::size_t drawn_lines_ = 0;
    struct sigaction before_ = {}; ///< previous action of SIGTSTP
};

/// Follows a score of a piece, which was submitted, to its end, and draws it on a terminal if that is
/// `wanted`.
stroke_report follow_drawn(session::play_session& session, const array& a, const piece& p, const score& s,
                           bool wanted);

} // namespace tactor::cli
