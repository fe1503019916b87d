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

/// When and for how long each channel was driven lately: drive_limits::max_drive_s counts this time. One
/// player gives it (player::history()), the next one goes on from it; save() and restore() bring it to
/// another process. A value, cheap to copy, empty at first. Any thread.
class TACTOR_API drive_history {
public:
    struct impl;

    drive_history() = default;

    /// Whether no channel is known to have been driven.
    [[nodiscard]] bool empty() const noexcept;
    /// This history together with what another player or process gave the same array. In no stretch of time
    /// does a channel count as driven for longer than the stretch lasts.
    [[nodiscard]] drive_history with(const drive_history& other) const;
    /// This history, as if each of the first `channels` channels were driven for `ahead_s` from now on. Save
    /// it while a stroke plays: if the process is killed, it cannot save how long it really drove them. A
    /// player that goes on from it drops the part that is still to come then.
    /// \throws error (bad_input) for more than 16384 channels, and for a time that is not 0 to 86400 s.
    [[nodiscard]] drive_history with_ahead(unsigned channels, double ahead_s) const;

    /// A text of a few lines, numbers in ns. It has at most 64 stretches of time for each channel: the oldest
    /// are joined, so that they leave the window later, never sooner.
    /// \throws error (runtime) when the process has no descriptors left: it asks which start of the machine
    ///         this is.
    [[nodiscard]] std::string save() const;
    /// The history that save() wrote, as of now. Empty for a text from another machine, or from before this
    /// machine was last started.
    /// \throws error: bad_input for a text that is not complete, runtime as save().
    [[nodiscard]] static drive_history restore(std::string_view text);

private:
    friend class player;
    explicit drive_history(std::shared_ptr<const impl> i) : impl_(std::move(i)) {}

    std::shared_ptr<const impl> impl_;
};

} // namespace v0
} // namespace tactor
