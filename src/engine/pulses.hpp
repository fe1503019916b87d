// SPDX-License-Identifier: MIT
/// \file
/// Sync pulses on a line at the moment a frame is at the DAC. Pure but for the clock and the line it is
/// given, so that tests run it on virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <tuple>

#include <tactor/gpio.hpp>
#include <tactor/player.hpp>

#include "engine/dac_clock.hpp"

namespace tactor::engine {

/// A pulse that is to come: a stream frame of one epoch. After an xrun the frame is never heard.
struct pulse {
    std::uint64_t epoch = 0;
    std::uint64_t frame = 0;
    stroke_id id = 0;
    auto operator<=>(const pulse&) const = default;
};

/// Counted since the beginning.
struct pulse_stats {
    std::uint64_t sent = 0;
    std::uint64_t missed = 0; ///< too late, or the line failed
    double mean_late_s = 0.0; ///< from the due time to the end of the call that switched the line
    double worst_late_s = 0.0;
};

/// The pulses that wait, by time.
class pulse_plan {
public:
    void add(const pulse& p) { waiting_.insert(p); }
    /// The stroke has ended: what it has not come to does not happen.
    void forget(stroke_id id);
    /// Forgets what belongs to another epoch than the clock's; the first of the others.
    std::optional<pulse> next(const clock_line& line);
    void take(const pulse& p) { waiting_.erase(p); }
    bool has(const pulse& p) const { return waiting_.contains(p); }

private:
    std::set<pulse> waiting_;
};

/// What the emitter needs of time.
class pulse_time {
public:
    virtual ~pulse_time() = default;
    virtual std::int64_t now() noexcept = 0;
    virtual void sleep_until(std::int64_t time_ns) noexcept = 0;
};

/// A pulse whose time was so long ago is not sent any more: a wrong time is worse than none.
inline constexpr std::int64_t latest_pulse_ns = 20'000'000;
/// From so long before a pulse is due on the emitter sleeps for it alone.
inline constexpr std::int64_t pulse_lead_ns = 2'000'000;

/// Sends one pulse after the other.
class pulse_emitter {
public:
    pulse_emitter(enable_line& line, std::int64_t pulse_ns, pulse_time& time) noexcept
        : line_(line), pulse_ns_(pulse_ns), time_(time)
    {
    }

    /// Sends `p`, which is due at `due_ns`, unless `still` says at the last moment that it is not to be.
    /// Blocks until the pulse is over.
    void send(std::int64_t due_ns, const std::function<bool()>& still) noexcept;
    const pulse_stats& stats() const noexcept { return stats_; }

private:
    enable_line& line_;
    std::int64_t pulse_ns_;
    pulse_time& time_;
    std::int64_t cost_ns_ = 0; ///< of switching, smoothed
    pulse_stats stats_;
};

} // namespace tactor::engine
