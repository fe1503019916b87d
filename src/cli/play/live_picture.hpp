// SPDX-License-Identifier: MIT
/// \file
/// The array on a terminal while it plays.
#pragma once

#include <csignal>
#include <functional>
#include <optional>

#include <tactor/tactor.hpp>

#include "cli/play/picture_lines.hpp"
#include "cli/play/terminal.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

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
