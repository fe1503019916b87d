// SPDX-License-Identifier: MIT
/// \file
/// Data that the control side and the audio thread share, and the messages in their rings. Messages are
/// trivially copyable.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactor/player.hpp>

#include "engine/dac_clock.hpp"
#include "rt/event_fd.hpp"
#include "rt/spsc_ring.hpp"
#include "rt/triple_buffer.hpp"
#include "synth/wave/event.hpp"

namespace tactor::engine {

class live_voice;

/// Maximum number of scores that the audio thread holds. Further scores wait on the control side.
inline constexpr std::uint32_t voices = 512;

/// Identifier of a score in the audio thread: its place in the thread's table plus voices * generation. A
/// score that the control side sends again after an xrun gets a new ticket. The audio thread ignores commands
/// with the old ticket that are still in the ring.
using ticket = std::uint32_t;

constexpr std::uint32_t ticket_place(ticket t) noexcept
{
    return t % voices;
}

/// Message from the control side to the audio thread. The audio thread handles commands in order of arrival.
struct command {
    enum class kind : std::uint32_t { begin, drive, end };
    kind what = kind::begin;
    ticket score = 0;
    stroke_id id = {};          ///< begin
    std::uint64_t at = 0;       ///< begin: stream frame; a past frame means now
    std::uint64_t length = 0;   ///< begin: frames
    synth::drive_event drive{}; ///< drive: frames count from the start of the score; `score` is the ticket
};

/// Message from the control side to the audio thread that overtakes waiting commands.
struct request {
    enum class kind : std::uint32_t { cancel, stop, live };
    kind what = kind::cancel;
    ticket score = 0;
    stroke_id id = {};           ///< live
    live_voice* voice = nullptr; ///< live: must outlive the ticket
    bool closing = false;        ///< stop: the player closes, so its strokes count as interrupted
};

/// Message from the audio thread to the control side.
struct report {
    enum class kind : std::uint32_t {
        begun,       ///< `frame`: stream frame at which the score starts
        over,        ///< `frame`: number of frames of the score that were played
        returned,    ///< an xrun, a suspend or a mute came before the score began: send it again
        stream_over, ///< the last report
    };
    kind what = kind::begun;
    ticket score = 0;
    state_kind state = state_kind::finished;
    reason_kind why = reason_kind::none;
    int code = 0; ///< negative errno of the device
    std::uint64_t frame = 0;
    bool started = false;        ///< over: the first sample has reached the DAC
    std::int64_t started_ns = 0; ///< over: CLOCK_MONOTONIC time of the first sample at the DAC
    live_delay delay = {};       ///< over: delays of a live stroke's points; `points` is 0 if there are none
};

enum class stream_stage : std::uint32_t { idle, running, suspended, closing, over };

/// Position of the stream. Stream frames continue to count across xruns.
struct stream_status {
    std::uint64_t written = 0; ///< next frame to be mixed
    std::uint64_t played = 0;
    std::uint64_t stroke_frame = 0;
    stroke_id stroke = {};
    bool sounding = false; ///< `stroke` is set
    bool running = false;
    stream_stage stage = stream_stage::idle;
    std::uint64_t epoch = 0;        ///< number of this start of the DAC; the first is 1
    std::uint64_t epoch_played = 0; ///< frames played in this epoch
    std::uint32_t mutes = 0;        ///< value of amplifier_link::mutes that the audio thread has handled
    std::uint64_t sounds_until = 0; ///< epoch frame at which the last of the strokes that have begun ends
};

/// State that the audio thread and the amplifier's thread share. The initial values mean: no amplifier.
struct amplifier_link {
    std::atomic<bool> ready{true};       ///< strokes may begin
    std::atomic<bool> off{true};         ///< the line is off, so the DAC may stop
    std::atomic<bool> stuck{false};      ///< switching off was given up; the line may be on or off
    std::atomic<bool> failed{false};     ///< the line cannot be switched, so the stream must end
    std::atomic<std::uint32_t> mutes{0}; ///< number of times that the line went off before the stream's end
    std::atomic<bool> ending{false};     ///< the audio thread has played the last sound or lost the device
    rt::event_fd wake;                   ///< signalled by the audio thread when something has changed
    rt::triple_buffer<stream_status> status{}; ///< read by the amplifier's thread
};

/// Counters. Only the audio thread writes them, unless noted.
struct counters {
    std::atomic<std::uint64_t> periods{0};
    std::atomic<std::uint64_t> frames{0};
    std::atomic<std::uint64_t> xruns{0};
    std::atomic<std::uint64_t> suspends{0};
    std::atomic<std::uint64_t> limited{0};
    std::atomic<std::uint64_t> low_water{UINT64_MAX};
    std::atomic<std::uint64_t> late_frames{0};
    std::atomic<std::uint64_t> power_limited{0};
    std::atomic<std::uint64_t> drives_cut{0};
    std::atomic<std::uint64_t> stalls{0};       ///< written by the amplifier's thread
    std::atomic<std::uint64_t> off_failures{0}; ///< written by the amplifier's thread
    std::atomic<bool> realtime_given_up{false}; ///< the audio thread ran too long and lost real-time priority
    std::atomic<std::uint64_t> minor_faults{0};
    std::atomic<std::uint64_t> major_faults{0};
    /// Lengths of the latest xruns. The length of xrun n is at index n modulo the size.
    std::array<std::atomic<std::int64_t>, 64> xrun_ns{};

    void count_xrun(std::int64_t length_ns) noexcept
    {
        const std::uint64_t n = xruns.load(std::memory_order_relaxed);
        xrun_ns[n % xrun_ns.size()].store(length_ns, std::memory_order_relaxed);
        xruns.store(n + 1, std::memory_order_release);
    }
};

/// Requested gain factors of scores, by place in the audio thread's table. The control side may write them at
/// any rate; the latest value counts.
class gain_requests {
public:
    void set(ticket t, float gain) noexcept
    {
        by_place_[ticket_place(t)].store((std::uint64_t{t} << 32U) | std::bit_cast<std::uint32_t>(gain),
                                         std::memory_order_relaxed);
        changed_.store(true, std::memory_order_release);
    }
    /// Returns the factor of a score, or 1 if none was set.
    float get(ticket t) const noexcept
    {
        const std::uint64_t v = by_place_[ticket_place(t)].load(std::memory_order_relaxed);
        return static_cast<ticket>(v >> 32U) == t ? std::bit_cast<float>(static_cast<std::uint32_t>(v))
                                                  : 1.0F;
    }
    bool take_change_flag() noexcept { return changed_.exchange(false, std::memory_order_acquire); }

private:
    std::array<std::atomic<std::uint64_t>, voices> by_place_{};
    std::atomic<bool> changed_{false};
};

/// Levels of drive time, s, that other programs and players have reached on the channels. The control side
/// sets them; the audio thread takes each level once.
class level_requests {
public:
    /// Sets the number of channels. Call it before the audio thread starts.
    void resize(std::size_t channels) { by_channel_ = std::vector<std::atomic<double>>(channels); }
    void set(std::size_t channel, double level_s) noexcept
    {
        if (channel >= by_channel_.size())
            return;
        by_channel_[channel].store(level_s, std::memory_order_relaxed);
        changed_.store(true, std::memory_order_release);
    }
    /// Calls `raise` with each channel and level that was set since the last call.
    template <typename Raise>
    void take(Raise raise) noexcept
    {
        if (!changed_.load(std::memory_order_relaxed) || !changed_.exchange(false, std::memory_order_acquire))
            return;
        for (std::size_t i = 0; i < by_channel_.size(); ++i)
            if (const double l = by_channel_[i].exchange(0.0, std::memory_order_relaxed); l > 0.0)
                raise(i, l);
    }

private:
    std::vector<std::atomic<double>> by_channel_;
    std::atomic<bool> changed_{false};
};

struct link {
    explicit link(std::size_t commands_in_ring = 2048) : commands(commands_in_ring) {}

    rt::spsc_ring<command> commands;
    // Cannot overflow: between two readings by the audio thread each voice gets at most three requests
    // (cancel, begin, cancel), and there are at most two stop requests.
    rt::spsc_ring<request> requests{std::size_t{4} * voices};
    // Cannot overflow: a ticket has at most two reports, and is reused only after its last one was read.
    rt::spsc_ring<report> reports{std::size_t{4} * voices};
    gain_requests gains;
    rt::event_fd to_audio;
    rt::event_fd to_control;
    /// Set by the feeder when the command ring is full. The audio thread then signals when there is space.
    std::atomic<bool> feeder_waits{false};
    /// Set by the feeder while it has strokes. The audio thread then wakes the control side regularly.
    std::atomic<bool> feeding{false};
    /// Stream status for the control side, which reads it under the player's mutex. Each reader has its own
    /// buffer, so that no reader waits for the audio thread, whatever the priorities are.
    rt::triple_buffer<stream_status> status;
    rt::triple_buffer<clock_line> clock;      ///< latest estimate of the DAC's clock, for the control side
    rt::triple_buffer<clock_line> sync_clock; ///< the same estimate, for the thread that sends sync pulses
    counters count;
    /// Number of frames in which each channel was driven. Empty if drive time is not counted.
    std::vector<std::atomic<std::uint64_t>> driven;
    level_requests raised;           ///< drive time of other programs and players on the same device
    std::atomic<bool> sounds{false}; ///< true while drives wait or sound
    amplifier_link amplifier;
};

} // namespace tactor::engine
