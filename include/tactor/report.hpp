// SPDX-License-Identifier: MIT
/// \file
/// How strokes and streams end.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// A stroke that a player was given. A plain value; the number is unique in one player, and 0 stands for
/// none.
struct stroke_id {
    std::uint32_t number = 0;

    friend constexpr auto operator<=>(const stroke_id&, const stroke_id&) noexcept = default;
};

/// How a submitted score ended. Each ends in exactly one of these.
enum class state_kind {
    finished,    ///< its last frame reached the DAC
    cancelled,   ///< faded out because it was asked for
    interrupted, ///< an xrun, the loss of the device, a failure, a live stroke's silent producer or its
                 ///< longest_s
};
TACTOR_KIND(state_kind);

/// Why a stroke was interrupted, or why a stream ended.
enum class reason_kind {
    none,      ///< neither: it finished or was cancelled; the stream was stopped by stop()
    xrun,      ///< the device ran dry
    suspended, ///< the system was suspended
    lost,      ///< the device is gone, its position stands still, or it had one xrun after the other
    failed,    ///< the device failed
    late,      ///< the computer was too slow to prepare the stroke in time
    crowded,   ///< too many strokes at once
    closed,    ///< the player was destroyed
    starved,   ///< live_options::timeout_s: no more points came
    too_long,  ///< live_options::longest_s
    muted,     ///< the amplifier was off
    amplifier, ///< the amplifier's line cannot be switched
    left_on,   ///< the amplifier's line cannot be switched off: it may be on
    plan,      ///< the plan or a model of one's own failed, or gave more than was promised
    handler,   ///< one of the program's handlers threw
};
TACTOR_KIND(reason_kind);

/// How long points of a live stroke took, from their time stamps until the first frame that they changed was
/// at the DAC. For the first point of a stroke this time is stroke_report::started_ns; for the others, the
/// one that the DAC's clock expects when they are rendered. Two kinds of points are not counted: those that
/// come before this clock is known, in a stream's first periods, and those that a newer one overtook before
/// the next period.
struct live_delay {
    std::uint64_t points = 0; ///< how many were counted
    double least_s = 0.0;     ///< below 0 where a time stamp lies in the future
    double mean_s = 0.0;
    double most_s = 0.0;
};

struct stroke_report {
    stroke_id id = {};
    state_kind state = state_kind::finished;
    std::uint64_t frames = 0;               ///< frames of it that were played, from its first on
    reason_kind reason = reason_kind::none; ///< why it was interrupted
    std::string why = {};                   ///< the same in words, with what else is known
    /// How much later than asked for its first sample was at the DAC; 0 when in time, and for
    /// start_at::now().
    double late_s = 0.0;
    /// When its first sample was at the DAC, CLOCK_MONOTONIC, as the DAC's clock said while that sample
    /// passed; none when it never sounded (`frames` is 0).
    std::optional<std::int64_t> started_ns = {};
    std::optional<live_delay> delay = {}; ///< of a live stroke, once a point of it has sounded
    std::uint64_t held_points = 0;        ///< of a live stroke: with an intensity above 1, which sounded as 1
};

/// How a stream ended.
struct stream_end {
    reason_kind reason = reason_kind::none; ///< none: stop() ended it in order
    std::string why = {};                   ///< the same for people; empty for none
};

/// How a call of wait() ended.
enum class wait_kind {
    ended,   ///< the stroke has ended, and here is its report
    timeout, ///< it has not ended: the time was over, or a handler asked, where wait() does not block
    taken,   ///< it has ended, but its report was given before, or dropped for 4096 newer ones
    unknown, ///< this player never had such a stroke
};
TACTOR_KIND(wait_kind);

/// What wait() gives: the report, or why there is none.
class wait_result {
public:
    wait_result(wait_kind without) noexcept : outcome_(without) {}
    wait_result(stroke_report r) noexcept : outcome_(wait_kind::ended), report_(std::move(r)) {}

    [[nodiscard]] wait_kind outcome() const noexcept { return outcome_; }
    /// Whether there is a report. Without one, `*` and `->` must not be used.
    explicit operator bool() const noexcept { return report_.has_value(); }
    const stroke_report& operator*() const noexcept { return *report_; }
    const stroke_report* operator->() const noexcept { return &*report_; }

private:
    wait_kind outcome_;
    std::optional<stroke_report> report_;
};

} // namespace v0
} // namespace tactor

template <>
struct std::hash<tactor::stroke_id> {
    std::size_t operator()(tactor::stroke_id id) const noexcept { return id.number; }
};

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
