// SPDX-License-Identifier: MIT
/// \file
/// The GPIO lines of a run, which outlive each of its players.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>

#include <tactor/tactor.hpp>

#include "session/environment.hpp"

namespace tactor::session {

/// `muted`: off, though the player that has the lines had switched it on.
enum class amplifier_state { none, off, on, muted };
/// "none", "off" or "on".
std::string_view to_string(amplifier_state s) noexcept;

/// Opens the lines that [amplifier] and [sync] name, unless no_gpio is set. Call it before threads and
/// locked memory: it forks the holder of the amplifier's line. `arm`: the trigger is wanted. \throws error as
/// open_amplifier() does.
player_lines open_lines(const stream_options& o, const environment& e, bool arm);

/// A player that plays on after its device was lost is a new one; the lines stay.
class lent_lines {
public:
    lent_lines() : lent_lines(player_lines{}) {}
    explicit lent_lines(player_lines own);
    /// Lends the lines to one player at a time. `proof_s`: as player_lines.
    player_lines lend(double proof_s = 0.0) const;

    /// Calls `f`, which must not throw, when the amplifier has gone on or off, in the thread that switches.
    void on_switch(std::function<void()> f) { state_->switched = std::move(f); }
    /// Returns what the line was switched to. Any thread.
    amplifier_state amplifier() const noexcept;

private:
    struct state {
        player_lines own;
        std::function<void()> switched = {};
        std::atomic<bool> on = false;
        std::atomic<bool> was_on = false; ///< with the player that has the lines
    };

    std::shared_ptr<state> state_;
};

} // namespace tactor::session
