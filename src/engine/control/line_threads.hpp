// SPDX-License-Identifier: MIT
/// \file
/// Threads that switch lines. One drives the amplifier's line as the audio thread's reports require, and
/// watches the audio thread. The other sends a sync pulse when a frame is at the DAC. Its plan and its
/// emitter get the clock and the line as arguments, so that tests can run them in virtual time.
#pragma once

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>

#include <tactor/lines.hpp>
#include <tactor/player.hpp>

#include "amplifier/amplifier.hpp"
#include "engine/dac_clock.hpp"
#include "engine/link.hpp"
#include "rt/event_fd.hpp"
#include "rt/thread.hpp"
#include "rt/triple_buffer.hpp"

namespace tactor::engine {

struct driver_options {
    amplifier::sequence_options amplifier{};
    std::int64_t beat_ns = 40'000'000;      ///< interval of beats; the holder waits for 150 ms
    std::int64_t watchdog_ns = 100'000'000; ///< time without a period after which the audio thread is stalled
    std::int64_t retry_ns = 10'000'000;     ///< pause between two attempts to switch off
    std::int64_t persist_ns = 1'000'000'000; ///< time for which attempts to switch off are repeated
};

/// Driver of the amplifier's line, without a thread; one caller at a time. Do not call it from the audio
/// thread, because the line's set() may block. Do not call it from the thread of the program's handlers,
/// because a slow handler could keep the holder waiting.
class amplifier_driver {
public:
    /// Starts with the line off. `clock`: CLOCK_MONOTONIC, ns. The references must outlive the driver.
    amplifier_driver(link& l, enable_line& line, const driver_options& o,
                     std::function<std::int64_t()> clock);

    /// Handles events. Call it after each wake-up, at the latest next_ns() after the previous call.
    void update() noexcept;
    std::int64_t next_ns() const noexcept;
    /// Switches off at once, and never on again. If the line refuses, update() tries again while
    /// is_retrying() is true.
    void close() noexcept;
    /// Returns true while the line refuses to go off and more attempts follow.
    bool is_retrying() const noexcept { return line_state_ == line_state::refused && !stuck_; }

private:
    void read_status(const stream_status& s, std::int64_t now) noexcept;
    void check_audio_thread(const stream_status& s, std::int64_t now) noexcept;
    void send_heartbeat(std::int64_t now) noexcept;
    void apply() noexcept;
    void report_changes() noexcept;
    void switch_on() noexcept;
    void switch_off() noexcept;
    void try_switch_off() noexcept;
    void fail() noexcept;

    link& link_;
    enable_line& line_;
    driver_options options_;
    std::function<std::int64_t()> clock_;
    amplifier::sequence amplifier_;
    enum class line_state { off, on, refused }; // refused: the line should be off, and may be on
    line_state line_state_ = line_state::off;
    bool stuck_ = false;          ///< the line has refused for persist_ns
    std::int64_t refused_ns_ = 0; ///< time of the first refusal
    std::int64_t tried_ns_ = 0;   ///< time of the last attempt
    std::uint64_t epoch_ = 0;
    std::uint64_t xruns_ = 0;
    std::uint64_t suspends_ = 0;
    std::uint64_t periods_ = 0;
    std::int64_t idle_ns_ = 0; ///< time in which no period was written
    std::int64_t updated_ns_ = 0;
    std::int64_t beaten_ns_ = 0;
    bool stalled_ = false;
    bool withheld_ = false;
    bool reported_ready_ = false;
    std::uint64_t reported_events_ = 0;
};

/// Thread of an amplifier_driver. It wakes when the audio thread signals and when the driver is due.
class amplifier_thread {
public:
    /// \throws std::system_error when no thread can be started.
    amplifier_thread(link& l, enable_line& line, const driver_options& o, const rt::thread_options& t);
    /// Switches the line off. Blocks while the line refuses and more attempts follow.
    ~amplifier_thread();
    amplifier_thread(const amplifier_thread&) = delete;
    amplifier_thread& operator=(const amplifier_thread&) = delete;

private:
    void run() noexcept;
    void sleep() noexcept;

    link& link_;
    amplifier_driver driver_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

/// A planned pulse: a stream frame of one epoch. After an xrun that frame is never played.
struct pulse {
    std::uint64_t epoch = 0;
    std::uint64_t frame = 0;
    stroke_id id = {};
    auto operator<=>(const pulse&) const = default;
};

/// Board with a few places for pulses. It has no lock, because the sending thread has the highest priority
/// and must not wait for another thread. Each place has a counter, `turn`, which is odd while a pulse waits
/// there. Either side may take the pulse by a compare-and-swap that adds one; the side whose swap succeeds
/// owns it.
class pulse_board {
public:
    static constexpr std::size_t places = 256;

    /// A pulse that was seen waiting.
    struct seen {
        pulse what;
        std::size_t place = 0;
        std::uint32_t turn = 0;
    };

    // Planning side: one caller at a time.

    /// Puts a pulse on the board for the sender. If the board is full, the latest pulse has to leave; returns
    /// that pulse, which may be `p` itself. Returns nothing if no pulse had to leave.
    std::optional<pulse> offer(const pulse& p) noexcept;
    /// Removes a stroke's pulses that the sender has not taken, and returns their number.
    std::size_t forget(stroke_id id) noexcept;
    void forget_other_epochs(std::uint64_t epoch) noexcept;

    // Sending side.

    /// Returns the earliest waiting pulse of the clock's epoch.
    std::optional<seen> next(const clock_line& line) const noexcept;
    /// Takes a pulse for sending. Returns false if the pulse has been removed since it was seen.
    bool take(const seen& s) noexcept { return end_turn(s.place, s.turn); }

private:
    struct place {
        std::atomic<std::uint32_t> turn{0};
        // Atomic, because a place may get another pulse while the sender reads it. `turn` shows this, and the
        // sender then drops what it has read.
        std::atomic<stroke_id> id{};
        std::atomic<std::uint64_t> epoch{0};
        std::atomic<std::uint64_t> frame{0};
    };

    static pulse read(const place& p) noexcept;
    static void fill(place& p, const pulse& what, std::uint32_t turn) noexcept;
    bool end_turn(std::size_t n, std::uint32_t turn) noexcept;
    template <typename Unwanted>
    std::size_t remove(Unwanted unwanted) noexcept;

    std::array<place, places> places_{};
};

/// Counts since the start.
struct pulse_stats {
    std::uint64_t sent = 0;
    std::uint64_t missed = 0; ///< too late, or the line failed
    double mean_late_s = 0.0; ///< from the due time to the end of the call that switched the line
    double worst_late_s = 0.0;
};

/// Waiting pulses; a score of many strokes may have thousands. The earliest pulses are on the board. One
/// caller at a time.
class pulse_plan {
public:
    explicit pulse_plan(pulse_board& b) noexcept : board_(b) {}

    /// Adds a pulse for the first sample of a stroke, and forgets the pulses of other epochs. `frame`: a
    /// frame of the running epoch, which `line` gives. Returns false if the frame is not in that epoch.
    bool add(stroke_id id, std::uint64_t frame, const clock_line& line);
    /// Drops the pulses of a stroke that has ended. If its first frame was played, they count as missed.
    void forget(stroke_id id, bool was_played);
    /// Moves pulses to free places of the board. Returns false if no pulse moved.
    bool hand_over();
    std::uint64_t missed() const noexcept { return missed_; }

private:
    pulse_board& board_;
    std::set<pulse> waiting_; ///< pulses without a place
    std::uint64_t missed_ = 0;
};

/// Clock that the emitter uses.
class pulse_time {
public:
    virtual ~pulse_time() = default;
    virtual std::int64_t now() noexcept = 0;
    virtual void sleep_until(std::int64_t time_ns) noexcept = 0;
};

/// Sender of pulses, one after the other.
class pulse_emitter {
public:
    pulse_emitter(enable_line& line, std::int64_t pulse_ns, pulse_time& time) noexcept
        : line_(line), pulse_ns_(pulse_ns), time_(time)
    {
    }

    /// Sleeps until the line must switch for a pulse at `due_ns`. Returns false if that time is too long ago.
    bool await(std::int64_t due_ns) noexcept;
    /// Sends the pulse that is due at `due_ns`. Blocks until the pulse is over.
    void send(std::int64_t due_ns) noexcept;
    /// Counts a pulse that came too late.
    void count_miss() noexcept { ++stats_.missed; }
    const pulse_stats& stats() const noexcept { return stats_; }

private:
    enable_line& line_;
    std::int64_t pulse_ns_;
    pulse_time& time_;
    std::int64_t cost_ns_ = 0; ///< duration of the call that switches the line, smoothed
    pulse_stats stats_;
};

/// Thread that sends pulses. The audio thread does not send them, because they would jitter by a period. This
/// thread has a higher priority, so it must not wait for any other thread: it shares neither a mutex nor the
/// heap with another thread. The members are for the control side, one caller at a time.
class trigger_thread {
public:
    /// Starts the thread, which reads link::sync_clock for the due times. `time`: null for CLOCK_MONOTONIC;
    /// tests give another clock.
    /// \throws std::system_error when no thread can be started.
    trigger_thread(link& l, enable_line& line, std::int64_t pulse_ns, const rt::thread_options& t,
                   pulse_time* time = nullptr);
    /// Ends the thread; the line is off afterwards.
    ~trigger_thread();
    trigger_thread(const trigger_thread&) = delete;
    trigger_thread& operator=(const trigger_thread&) = delete;

    /// Plans a pulse for the time when this frame of the stream is at the DAC, in the running epoch of
    /// `clock`.
    void add(stroke_id id, std::uint64_t frame, const clock_line& clock);
    void forget(stroke_id id, bool was_played) { plan_.forget(id, was_played); }
    /// Moves pulses to free places of the board. Called after link::to_control was signalled.
    void hand_over();
    pulse_stats stats() noexcept;

private:
    void run() noexcept;
    std::int64_t step() noexcept;

    link& link_;
    enable_line& line_;
    pulse_board board_;
    pulse_plan plan_{board_}; ///< used by the control side
    rt::triple_buffer<pulse_stats> stats_;
    pulse_time& time_;
    pulse_emitter emitter_;
    rt::event_fd wake_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

} // namespace tactor::engine
