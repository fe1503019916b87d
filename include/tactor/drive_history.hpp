// SPDX-License-Identifier: MIT
/// \file
/// For how long tactors were driven lately, from one player to the next.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// For how long each channel was driven lately, and when that was: what drive_limits::max_drive_s goes by.
/// One player gives it (player::history()), the next goes on from it; save() and restore() bring it to
/// another process. A value, cheap to copy, empty at first. Any thread.
class TACTOR_API drive_history {
public:
    struct impl;

    drive_history() = default;

    /// Whether no channel is known to have been driven.
    [[nodiscard]] bool empty() const noexcept;
    /// This, and what another player or process gave the same array: no channel counts as driven for longer
    /// than there was time.
    [[nodiscard]] drive_history with(const drive_history& other) const;
    /// This, and each of so many channels driven for `ahead_s` from now on: what to save while a stroke
    /// plays, for the process may not live to say what came of it. What is still to come when a player goes
    /// on from it did not come. \throws error (bad_input) for more than 16384 channels, and for what is no
    /// time of 0 to 86400 s.
    [[nodiscard]] drive_history with_ahead(unsigned channels, double ahead_s) const;

    /// A text of a few lines, numbers in ns: at most 64 stretches of time a channel, the oldest taken
    /// together, which leave the window later then, never sooner.
    [[nodiscard]] std::string save() const;
    /// What save() said on this machine since it was started, as of now; empty where it was before that.
    /// \throws error (bad_input) for a text that is not whole.
    [[nodiscard]] static drive_history restore(std::string_view text);

private:
    friend class player;
    explicit drive_history(std::shared_ptr<const impl> i) : impl_(std::move(i)) {}

    std::shared_ptr<const impl> impl_;
};

} // namespace v0
} // namespace tactor
