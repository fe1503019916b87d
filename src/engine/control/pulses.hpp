// SPDX-License-Identifier: MIT
/// \file
/// Sync pulses on a line at the moment a frame is at the DAC. Pure but for the clock and the line it is
/// given, so that tests run it on virtual time.
#pragma once

#include <cstdint>
#include <set>

#include <tactor/lines.hpp>

#include "engine/audio/dac_clock.hpp"
#include "engine/control/pulse_board.hpp"

namespace tactor::engine {

/// Counted since the beginning.
struct pulse_stats {
    std::uint64_t sent = 0;
    std::uint64_t missed = 0; ///< too late, or the line failed
    double mean_late_s = 0.0; ///< from the due time to the end of the call that switched the line
    double worst_late_s = 0.0;
};

/// All pulses that wait; a score of many strokes may have thousands. The first ones stand on the board. One
/// caller at a time.
class pulse_plan {
public:
    explicit pulse_plan(pulse_board& b) noexcept : board_(b) {}

    /// Adds the pulse for a stroke's first sample, at a frame of the running epoch, which `line` names;
    /// forgets the pulses of other epochs. False where this frame does not come in the epoch.
    bool add(stroke_id id, std::uint64_t frame, const clock_line& line);
    /// The stroke has ended: its pulses that still wait are not sent. Where its first frame was played, they
    /// count as missed.
    void forget(stroke_id id, bool was_played);
    /// Moves pulses to the board as far as it has places. False where none was moved.
    bool hand_over();
    std::uint64_t missed() const noexcept { return missed_; }

private:
    pulse_board& board_;
    std::set<pulse> waiting_; ///< for a place
    std::uint64_t missed_ = 0;
};

/// The clock that the emitter needs.
class pulse_time {
public:
    virtual ~pulse_time() = default;
    virtual std::int64_t now() noexcept = 0;
    virtual void sleep_until(std::int64_t time_ns) noexcept = 0;
};

/// A pulse that is later than this is not sent any more: a wrong time is worse than none.
inline constexpr std::int64_t latest_pulse_ns = 20'000'000;
/// So long before a pulse is due, the emitter begins to sleep for this pulse alone.
inline constexpr std::int64_t pulse_lead_ns = 2'000'000;

/// Sends one pulse after the other.
class pulse_emitter {
public:
    pulse_emitter(enable_line& line, std::int64_t pulse_ns, pulse_time& time) noexcept
        : line_(line), pulse_ns_(pulse_ns), time_(time)
    {
    }

    /// Sleeps until the line is to be switched for a pulse at `due_ns`. False when that was too long ago.
    bool await(std::int64_t due_ns) noexcept;
    /// Sends what was awaited. Blocks until the pulse is over.
    void send(std::int64_t due_ns) noexcept;
    /// Counts a pulse that came too late.
    void miss() noexcept { ++stats_.missed; }
    const pulse_stats& stats() const noexcept { return stats_; }

private:
    enable_line& line_;
    std::int64_t pulse_ns_;
    pulse_time& time_;
    std::int64_t cost_ns_ = 0; ///< of switching, smoothed
    pulse_stats stats_;
};

} // namespace tactor::engine
