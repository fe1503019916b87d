// SPDX-License-Identifier: MIT
/// \file
/// The audio thread, its table of scores, and its loop. Tests step the loop without threads or a clock.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <poll.h>

#include <tactor/sink.hpp>

#include "engine/dac_clock.hpp"
#include "engine/link.hpp"
#include "engine/live.hpp"
#include "rt/nonblocking.hpp"
#include "rt/thread.hpp"
#include "synth/mix/mixer.hpp"

namespace tactor::engine {

/// Table of the scores in the audio thread. It reports exactly one end for each score that begins. Frames
/// count from the start of the epoch, as in the mixer, unless called stream frames. Audio thread only; never
/// allocates.
class score_table {
public:
    /// Makes an empty table. `reserve`: number of the mixer's drives kept for live strokes. `ramp_frames`:
    /// duration of a gain change.
    score_table(synth::mixer& m, link& l, std::uint32_t fade_frames, std::size_t reserve,
                std::uint32_t ramp_frames) noexcept
        : mixer_(m), link_(l), fade_(fade_frames), ramp_(ramp_frames), reserve_(reserve)
    {
    }

    /// Returns true if the ticket was cancelled (and reported) before its begin command arrived. Call it once
    /// for each begin.
    bool take_cancellation(ticket t) noexcept;
    /// Begins a score. `offset`: stream frame at which the epoch began.
    void begin(const command& c, std::uint64_t offset) noexcept;
    /// Adds a drive. Returns false if the mixer has no space now; the same command must come again.
    bool add(const command& c) noexcept;
    /// Records that the drives do not fit into the mixer or the ring. If a drive is late within the next
    /// crowd_frames, this is the reported reason.
    void record_crowding() noexcept;
    void end(ticket t) noexcept;
    /// Adds a live stroke. It is silent until its first point has come and fewer than live_voices strokes
    /// sound. Precondition: a place is free.
    void begin_live(const request& r) noexcept;
    /// Ends live strokes whose producer requests it or sends no points for too long, and those that last too
    /// long.
    void handle_live_requests() noexcept;
    /// Moves the gains of scores towards the requested gains. Called before each mix.
    void update_gains() noexcept;
    /// Adds the live strokes' drives of the next frames. Called before each mix. `offset`: stream frame at
    /// which the epoch began. `clock` may be invalid.
    void render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Fades out scores that would break off within two periods because their next drives have not come.
    /// Called before each mix.
    void fade_late_scores(std::uint64_t period) noexcept;
    /// Fades a score out, or ends it at once if it has not begun. Its begin command may still come.
    void cancel(ticket t) noexcept;
    /// Fades all scores out. Scores that have not begun, and scores that begin later, end at once.
    void stop(state_kind s, reason_kind why) noexcept;
    /// Handles a mute: fades out the scores that sound, and returns the others to the control side.
    void mute() noexcept;

    /// Records when each score's first sample was at the DAC, once the `played` frames include that sample.
    /// `clock` must be valid, for the epoch that began at stream frame `offset`. Called before update() and
    /// interrupt().
    void record_start_times(std::uint64_t played, std::uint64_t offset, const clock_line& clock) noexcept;
    /// Ends the scores that are over now that `played` frames have reached the DAC. Starts fades that had to
    /// wait.
    void update(std::uint64_t played) noexcept;

    /// Handles a break of the stream. Ends the scores that had begun to sound. Returns the other scores to
    /// the control side if `give_back`, else ends them, too.
    void interrupt(reason_kind why, int code, std::uint64_t played, bool give_back) noexcept;

    bool empty() const noexcept { return used_ == 0; }
    /// Fills `s` with the newest score that sounds at `played`, and with the frame at which the last score in
    /// the mix ends. A score that still waits to fade counts as endless.
    void describe(std::uint64_t played, stream_status& s) const noexcept;
    /// Returns true if a score that sounds now still waits for drives.
    bool needs_drives() const noexcept;

private:
    /// Value of `base` before a live stroke's first point, and of `length` while a live stroke gets points.
    static constexpr std::uint64_t never = std::uint64_t{1} << 62;

    /// Number of frames after a full mixer or ring within which a late drive is reported as crowded.
    static constexpr std::uint64_t crowd_frames = 8192;

    struct entry {
        ticket score = 0;
        stroke_id id = {};
        std::uint64_t base = 0;
        std::uint64_t length = 0;
        std::uint64_t finish = 0;  ///< the score is over once this frame has been played
        std::uint64_t covered = 0; ///< end of its drives so far
        std::uint32_t fade = 0;    ///< length of its final fade, frames
        bool open = false;         ///< another drive must follow, because the score still sounds at `covered`
        bool ahead = false;        ///< earlier drives came in time
        bool used = false;
        bool fed = false;
        bool fade_wanted = false;
        bool fading = false;
        bool started = false; ///< the first sample has reached the DAC, at started_ns
        std::int64_t started_ns = 0;
        float gain = 1.0F;
        bool sounds = false;               ///< counts against live_voices
        live_voice* live = nullptr;        ///< set while a live stroke gets points
        const live_voice* voice = nullptr; ///< set for a live stroke until its end
        state_kind state = state_kind::finished;
        reason_kind why = reason_kind::none;
    };

    entry* find(ticket t) noexcept;
    void handle_live_requests(entry& e) noexcept;
    void render_live(entry& e, std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept;
    void close_live(entry& e) noexcept;
    reason_kind late_reason() const noexcept;
    static void record_drive_end(entry& e, const synth::drive_event& d) noexcept;
    void update_gain(entry& e, std::uint32_t ramp) noexcept;
    void forget(entry& e) noexcept;
    void request_fade(entry& e, state_kind s, reason_kind why) noexcept;
    void fade(entry& e) noexcept;
    void end_entry(entry& e, state_kind s, reason_kind why, int code, std::uint64_t frames) noexcept;

    synth::mixer& mixer_;
    link& link_;
    std::uint32_t fade_;
    std::uint32_t ramp_;
    std::size_t reserve_;
    std::array<entry, voices> entries_{};
    std::uint64_t full_until_ = 0; ///< drives that are late before this frame count as crowded
    std::uint32_t used_ = 0;
    std::uint32_t top_ = 0; ///< entries from this index on were never used
    /// Number of begin commands in the ring whose scores have been cancelled and reported, by place. These
    /// commands come before any other begin command of the same place, because a place is reused only when
    /// its ticket has ended.
    std::array<std::uint32_t, voices> called_off_{};
    std::array<entry*, live_places> live_{}; ///< in the order in which they began
    std::size_t live_count_ = 0;
    std::size_t live_sounding_ = 0; ///< number of live strokes that sound
    bool stopping_ = false;
    state_kind stop_state_ = state_kind::cancelled;
    reason_kind stop_reason_ = reason_kind::none;
};

/// Wrapper of the sink whose calls may enter the kernel. ALSA locks the handle's mutex in these calls, but
/// only the audio thread uses that mutex.
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

/// Longest time from a stop to the end of its fade. Strokes that still sound then are cut.
inline constexpr std::int64_t longest_stop_ns = 400'000'000;

struct loop_options {
    std::uint32_t fade_frames = 480;
    std::uint64_t horizon_frames = 24'000; ///< the control side wakes after each eighth of the horizon
    std::int64_t stall_ns = 500'000'000;   ///< time after which a device that stands still counts as lost
    std::size_t drives = 8192;             ///< capacity of the mixer
    bool amplifier = false;                ///< true if link::amplifier drives an amplifier
    /// Maximum time for which the end of the stream waits for the amplifier to go off: one second for a
    /// holder that hangs, and one second to retry a line that refuses.
    std::int64_t off_ns = 2'000'000'000;
    synth::guard_settings guards{};
    std::vector<double> driven_s = {}; ///< levels of drive time, by channel
};

/// Loop of the audio thread. It owns the mixer and controls the stream. After the constructor, no member but
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
    bool process_command(const command& c) noexcept;

    io_result begin_epoch() noexcept;
    io_result write_pending() noexcept;
    void write_if_ready(io_kind ready, std::int64_t now) noexcept;
    void write_periods(std::int64_t now) noexcept;
    void mix_period() noexcept;
    void update_position(std::int64_t now) noexcept;
    void record_start_times(std::uint64_t played) noexcept;
    void record_progress(std::int64_t now) noexcept;
    void begin_running(std::int64_t now) noexcept;

    void handle_break(io_kind s, int code, std::int64_t now) noexcept;
    void silence_all(reason_kind why, int code, std::uint64_t played) noexcept;
    void handle_suspend(int code, std::int64_t now) noexcept;
    void try_resume(std::int64_t now) noexcept;
    void restart(std::int64_t now) noexcept;
    bool exceeds_recovery_limit(std::int64_t now) noexcept;
    void finish(reason_kind why, int code, bool runs = false) noexcept;
    void advance_closing(io_kind ready, std::int64_t now) noexcept;
    void end() noexcept;
    void handle_amplifier_state() noexcept;
    void request_stop() noexcept;
    void finish_if_silent() noexcept;
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
    std::uint32_t mutes_ = 0;                 ///< value of link::amplifier.mutes that was handled last
    bool end_runs_ = false;                   ///< closing: zeros are written until the end
    reason_kind end_why_ = reason_kind::none; ///< closing: reason of the end
    int end_code_ = 0;
    std::int64_t now_ns_ = 0;
    std::int64_t closing_ns_ = 0;
    stream_stage reported_stage_ = stream_stage::idle;
    std::uint64_t reported_epoch_ = 0;
    bool reported_clocked_ = false;
    std::uint64_t stop_frame_ = 0;  ///< frame at which the stop completes; 0 while something sounds
    std::uint64_t offset_ = 0;      ///< stream frame at which this epoch began
    std::uint64_t played_ = 0;      ///< frames played in this epoch
    std::uint64_t woken_frame_ = 0; ///< stream frame at which the control side was last woken
    std::int64_t epoch_ns_ = 0;     ///< start time of the DAC
    std::int64_t moved_ns_ = 0;     ///< time when the position last moved
    bool fresh_ = false;            ///< the stream has just started; the start may take longer than stall_ns
    unsigned still_steps_ = 0;      ///< wake-ups since the position last moved
    unsigned idle_steps_ = 0;       ///< wake-ups since the position moved or the sink took a frame
    std::int64_t suspended_ns_ = 0;
    std::array<std::int64_t, 3> recoveries_{};
    std::size_t recovered_ = 0;
};

/// The audio thread: an audio_loop that waits on real descriptors.
class audio_thread {
public:
    /// Starts the stream and the thread. The references must outlive the object.
    /// \throws std::system_error when no thread can be started.
    audio_thread(audio_loop& loop, sink& s, link& l, const rt::thread_options& o);

    const io_result& started() const noexcept { return started_; }
    int fifo_error() const noexcept { return thread_->fifo_error(); }
    void join() noexcept { thread_->join(); }

private:
    void run() noexcept TACTOR_NONBLOCKING;
    io_kind wait() noexcept;

    audio_loop& loop_;
    sink& sink_;
    link& link_;
    std::vector<pollfd> fds_; ///< the sink's descriptors, then the eventfd
    io_result started_;
    std::unique_ptr<rt::thread> thread_;
};

} // namespace tactor::engine
