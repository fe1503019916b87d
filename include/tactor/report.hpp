// SPDX-License-Identifier: MIT
/// \file
/// Reports about strokes and streams that have ended.
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

/// Identifier of a stroke of a player. A plain value. The number is unique in one player; 0 means no stroke.
struct stroke_id {
    std::uint32_t number = 0;

    friend constexpr auto operator<=>(const stroke_id&, const stroke_id&) noexcept = default;
};

/// Way in which a submitted score ended. Each score ends in exactly one of these.
enum class state_kind {
    finished,    ///< its last frame reached the DAC
    cancelled,   ///< faded out on request
    interrupted, ///< ended by an xrun, the loss of the device, a failure, a live stroke's silent producer or
                 ///< its longest_s
};
TACTOR_KIND(state_kind);

/// Reason why a stroke was interrupted, or why a stream ended.
enum class reason_kind {
    none,      ///< the stroke finished or was cancelled; stop() stopped the stream
    xrun,      ///< the device ran dry
    suspended, ///< the system was suspended
    lost,      ///< the device is gone, its position stands still, or one xrun followed another
    failed,    ///< the device failed
    late,      ///< the computer was too slow to prepare the stroke in time
    crowded,   ///< too many strokes at once
    closed,    ///< the player was destroyed
    starved,   ///< live_options::timeout_s: no more points came
    too_long,  ///< live_options::longest_s
    muted,     ///< the amplifier was off
    amplifier, ///< the amplifier's line cannot be switched
    left_on,   ///< the amplifier's line cannot be switched off: it may be on
    plan,      ///< live strokes: a custom phantom model failed, or gave more than the intensity
    handler,   ///< one of the program's handlers threw
};
TACTOR_KIND(reason_kind);

/// Delays of a live stroke's points: from their time stamps until the first frame that they changed was at
/// the DAC. For the first point of a stroke that time is stroke_report::started_ns. For the others it is the
/// one that the DAC's clock predicts when they are rendered. Two kinds of points do not count: those that
/// come in a stream's first periods, before this clock is known, and those that a newer point overtook before
/// the next period.
struct live_delay {
    std::uint64_t points = 0; ///< number of points that count
    double least_s = 0.0;     ///< below 0 if a time stamp lies in the future
    double mean_s = 0.0;
    double most_s = 0.0;
};

/// Report about one stroke that has ended.
struct stroke_report {
    stroke_id id = {};
    state_kind state = state_kind::finished;
    std::uint64_t frames = 0;               ///< frames that were played, from its first on
    reason_kind reason = reason_kind::none; ///< reason of an interruption
    std::string why = {};                   ///< the reason in words, with further details
    /// Delay of its first sample at the DAC after the requested time; 0 if in time, and for start_at::now().
    double late_s = 0.0;
    /// Time of its first sample at the DAC, CLOCK_MONOTONIC, from the DAC's clock while that sample passed;
    /// none if it never sounded (`frames` is 0).
    std::optional<std::int64_t> started_ns = {};
    std::optional<live_delay> delay = {}; ///< live strokes only, after a point has sounded
    std::uint64_t held_points = 0;        ///< live strokes only: points above intensity 1, which sounded as 1
    std::uint64_t outside_points = 0;     ///< live strokes only: points outside the array, moved to its edge
};

/// End of a stream.
struct stream_end {
    reason_kind reason = reason_kind::none; ///< none: stop() ended it in order
    std::string why = {};                   ///< the reason for people; empty for none
};

/// Outcome of a call of wait().
enum class wait_kind {
    ended,   ///< the stroke has ended, and its report is there
    timeout, ///< it has not ended: the time was over, or the caller is a handler, where wait() does not block
    taken,   ///< it has ended, but its report was returned before, or dropped for 4096 newer ones
    unknown, ///< this player never had such a stroke
};
TACTOR_KIND(wait_kind);

/// Result of wait(): the report, or the reason why there is none.
class wait_result {
public:
    wait_result(wait_kind without) noexcept : outcome_(without) {}
    wait_result(stroke_report r) noexcept : outcome_(wait_kind::ended), report_(std::move(r)) {}

    [[nodiscard]] wait_kind outcome() const noexcept { return outcome_; }
    /// Returns true if there is a report. Without one, `*` and `->` must not be used.
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
