// SPDX-License-Identifier: MIT
/// \file
/// The audio thread's work, one step at a time, without threads or a clock, so that tests can step it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactor/sink.hpp>

#include "engine/audio/dac_clock.hpp"
#include "engine/audio/score_table.hpp"
#include "engine/link.hpp"
#include "rt/nonblocking.hpp"
#include "synth/mix/mixer.hpp"

namespace tactor::engine {

/// The sink as the audio loop calls it: these calls may enter the kernel. ALSA locks a mutex of the handle in
/// them, which only the audio thread uses.
class device {
public:
    explicit device(sink& s) noexcept : sink_(s) {}

    io_kind prepare() noexcept { return enter(&sink::prepare); }
    io_kind start() noexcept { return enter(&sink::start); }
    io_kind resume() noexcept { return enter(&sink::resume); }
    std::int64_t xrun_ns() noexcept { return enter(&sink::xrun_ns); }
    io_result available() noexcept { return enter(&sink::available); }
    io_result write(std::span<const std::byte> frames) noexcept { return enter(&sink::write, frames); }
    stream_position position() noexcept { return enter(&sink::position); }
    void drop() noexcept { return enter(&sink::drop); }

private:
    template <typename Result, typename... Args>
    Result enter(Result (sink::*call)(Args...) noexcept, Args... args) noexcept
    {
        const rt::permitted_call here{};
        return (sink_.*call)(args...);
    }

    sink& sink_;
};

/// Longest time from a stop to the end of its fade. What sounds then is cut.
inline constexpr std::int64_t longest_stop_ns = 400'000'000;

struct loop_options {
    std::uint32_t fade_frames = 480;
    std::uint64_t horizon_frames = 24'000; ///< the control side wakes after each eighth of it
    std::int64_t stall_ns = 500'000'000;   ///< time after which a device that stands still counts as lost
    std::size_t drives = 8192;             ///< capacity of the mixer
    bool amplifier = false;                ///< true if link::amplifier drives an amplifier
    /// Time that the end waits for the amplifier to go off: a holder that hangs takes a second, and a line
    /// that refuses is tried again for another.
    std::int64_t off_ns = 2'000'000'000;
    synth::guard_settings guards{};
    std::vector<double> driven_s = {}; ///< levels of drive time, by channel
};

/// Owner of the mixer; decides everything that happens to the stream. After the constructor, no member but
/// the destructor allocates, locks, throws or blocks. `now` is CLOCK_MONOTONIC in ns.
class audio_loop {
public:
    audio_loop(sink& s, link& l, std::span<const double> limits, const loop_options& o);

    /// Begins the first epoch: prepare, silence, start.
    io_result start(std::int64_t now) noexcept;

    /// Handles one wake-up. `ready`: result of sink::ready(), or `again` if it was not called.
    void step(io_kind ready, std::int64_t now) noexcept TACTOR_NONBLOCKING;

    /// Returns true if the stream has ended. Then the last report is in the ring.
    bool over() const noexcept { return phase_ == phase::over; }
    /// Returns true if the sink's descriptors should be polled now.
    bool polls_sink() const noexcept;
    /// Returns the number of drives that wait or sound.
    std::size_t drives() const noexcept { return mixer_.size(); }
    /// Returns the longest time until the next wake-up, ns.
    std::int64_t timeout_ns() const noexcept;

private:
    using phase = stream_stage;

    void take_requests() noexcept;
    void take_commands() noexcept;
    bool take(const command& c) noexcept;

    io_result begin_epoch() noexcept;
    io_result write_pending() noexcept;
    void write_periods(std::int64_t now) noexcept;
    void mix_period() noexcept;
    void look_at_position(std::int64_t now) noexcept;
    void note_starts(std::uint64_t played) noexcept;
    void moved(std::int64_t now) noexcept;
    void run_from(std::int64_t now) noexcept;

    void broken(io_kind s, int code, std::int64_t now) noexcept;
    void silence_all(reason_kind why, int code, std::uint64_t played) noexcept;
    void fall_asleep(int code, std::int64_t now) noexcept;
    void try_resume(std::int64_t now) noexcept;
    void restart(std::int64_t now) noexcept;
    bool too_often(std::int64_t now) noexcept;
    void finish(reason_kind why, int code, bool runs = false) noexcept;
    void close_step(io_kind ready, std::int64_t now) noexcept;
    void end() noexcept;
    void obey_amplifier() noexcept;
    void request_stop() noexcept;
    void finish_when_silent() noexcept;
    void publish_clock(const clock_line& line) noexcept;
    void publish() noexcept;

    device sink_;
    link& link_;
    loop_options options_;
    stream_setup setup_;
    synth::mixer mixer_;
    score_table scores_;
    dac_clock clock_;
    std::size_t frame_bytes_;
    std::vector<std::byte> block_; ///< one period
    std::size_t pending_ = 0;      ///< frames of block_ that the sink has not taken yet
    std::size_t pending_from_ = 0;

    phase phase_ = phase::idle;
    bool stop_requested_ = false;
    std::int64_t stop_requested_ns_ = 0;
    reason_kind stop_why_ = reason_kind::none;
    std::uint32_t mutes_ = 0;                 ///< value of link::amplifier.mutes that was obeyed last
    bool end_runs_ = false;                   ///< closing: zeros are written meanwhile
    reason_kind end_why_ = reason_kind::none; ///< closing
    int end_code_ = 0;
    std::int64_t now_ns_ = 0;
    std::int64_t closing_ns_ = 0;
    stream_stage reported_stage_ = stream_stage::idle;
    std::uint64_t reported_epoch_ = 0;
    bool reported_clocked_ = false;
    std::uint64_t stop_frame_ = 0;  ///< 0: not silent yet
    std::uint64_t offset_ = 0;      ///< stream frame at which this epoch began
    std::uint64_t played_ = 0;      ///< of this epoch
    std::uint64_t woken_frame_ = 0; ///< stream frame at which the control side was last woken
    std::int64_t epoch_ns_ = 0;     ///< start time of the DAC
    std::int64_t moved_ns_ = 0;     ///< time when the position last moved
    bool fresh_ = false;            ///< the stream has just started, which may have taken longer than a stall
    unsigned still_steps_ = 0;      ///< wake-ups since then
    unsigned idle_steps_ = 0;       ///< wake-ups since the position moved or a frame was taken
    std::int64_t suspended_ns_ = 0;
    std::array<std::int64_t, 3> recoveries_{};
    std::size_t recovered_ = 0;
};

} // namespace tactor::engine
