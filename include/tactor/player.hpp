// SPDX-License-Identifier: MIT
/// \file
/// The engine: plays scores on a sink in real time.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/live.hpp>
#include <tactor/render.hpp>
#include <tactor/report.hpp>
#include <tactor/sink.hpp>

namespace tactor::detail {

/// Types that can count frames or nanoseconds. Seconds in a double would be taken for a count of 0 or 1.
template <typename T>
concept whole_number = std::integral<T> && !std::same_as<T, bool>;
template <typename T>
concept no_count = std::floating_point<T> || std::same_as<T, bool>;

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

/// What a stroke's start waits for.
enum class start_kind { frame, time, trigger };
TACTOR_KIND(start_kind);

/// When a stroke starts. A plain value.
class start_at {
public:
    start_at(const auto& frame_or_seconds) = delete; ///< say which: frame(), time()

    /// With the next period that is written.
    [[nodiscard]] static constexpr start_at now() noexcept { return {}; }
    /// From a frame of the stream on. A frame that has been written already means as soon as possible; a
    /// stroke whose frame never comes waits until it is cancelled. The count of frames goes on over an xrun.
    /// \throws error (bad_input) for a negative frame.
    template <detail::whole_number T>
    [[nodiscard]] static constexpr start_at frame(T stream_frame)
    {
        if constexpr (std::signed_integral<T>)
            if (stream_frame < 0)
                refuse_frame(stream_frame);
        start_at s;
        s.frame_ = static_cast<std::uint64_t>(stream_frame);
        return s;
    }
    template <detail::no_count T>
    static start_at frame(T seconds) = delete;
    /// The first sample is at the DAC at this time, CLOCK_MONOTONIC in ns: within half a frame and the error
    /// of the DAC clock. A time that has passed means as soon as possible; see stroke_report::late_s. Any
    /// number may be given.
    template <detail::no_count T>
    static start_at time(T seconds) = delete;
    [[nodiscard]] static constexpr start_at time(std::int64_t monotonic_ns) noexcept
    {
        start_at s;
        s.kind_ = start_kind::time;
        s.time_ns_ = monotonic_ns;
        return s;
    }
    /// Armed: waits, silent, for an edge at player_lines::trigger or for player::fire(), whichever is first.
    [[nodiscard]] static constexpr start_at trigger() noexcept
    {
        start_at s;
        s.kind_ = start_kind::trigger;
        return s;
    }

    [[nodiscard]] constexpr start_kind what() const noexcept { return kind_; }
    [[nodiscard]] constexpr std::uint64_t stream_frame() const noexcept { return frame_; }
    [[nodiscard]] constexpr std::int64_t time_ns() const noexcept { return time_ns_; }

private:
    constexpr start_at() noexcept = default;
    [[noreturn]] TACTOR_API static void refuse_frame(long long stream_frame);

    start_kind kind_ = start_kind::frame;
    std::uint64_t frame_ = 0;
    std::int64_t time_ns_ = 0;
};

struct player_options {
    /// How far ahead drives are handed to the audio thread; two buffers and four periods at least.
    double horizon_s = 0.5;
    double fade_s = 0.010; ///< fade on cancel and stop
    /// A device whose position stands still for so long, and for 16 periods at least, counts as lost.
    double stall_s = 0.5;
    bool realtime = true;          ///< ask for SCHED_FIFO
    bool require_realtime = false; ///< \throws instead of going on without it
    int priority = 65;
    /// Limits on the power of all tactors and on the time of each, whatever the scores ask for.
    drive_limits limits = {};
    /// History of the player before, if it had the same array: when a lost device is opened again, a tactor
    /// does not get the time back that it has used up. Channels count from 0 in both.
    drive_history driven = {};
    /// Is told of the stream's start and end, xruns and recovery, mutes of the amplifier, and limits that
    /// acted.
    log_function log = {};
};

/// Counters since the player was opened.
struct player_stats {
    std::uint64_t periods = 0;
    std::uint64_t frames = 0; ///< frames written
    std::uint64_t xruns = 0;
    std::uint64_t limited_frames = 0;       ///< samples that a channel's own limit changed
    std::uint64_t power_limited_frames = 0; ///< frames in which drive_limits::power_dbfs acted
    std::uint64_t drives_cut = 0;           ///< drives cut short, or silent, for drive_limits::max_drive_s
    /// How often the amplifier was switched off because the audio thread, or the whole process, stood still.
    std::uint64_t stalls = 0;
    /// How often the amplifier's line refused to be switched off. It is tried again for a second.
    std::uint64_t off_failures = 0;
    /// All these tries failed: the amplifier may be on. player::ended() says so too.
    bool left_on = false;
    std::uint64_t sync_pulses = 0; ///< sent on player_lines::sync_out
    std::uint64_t sync_missed = 0; ///< not sent, because their time was over or the line failed
    double sync_mean_late_s = 0.0; ///< the line's switching after the frame's time by the DAC clock
    double sync_worst_late_s = 0.0;
    std::uint64_t ring_low_water = 0; ///< fewest drives that waited while a stroke played
    double latest_wakeup_s = 0.0;
    /// Page faults of the audio thread after its first wake-ups: 0 where memory is locked. Counted once a
    /// second.
    std::uint64_t minor_faults = 0;
    std::uint64_t major_faults = 0; ///< those that had to wait for a disk
    /// The audio thread has SCHED_FIFO. It gives SCHED_FIFO up after working for some 0.1 s without a pause:
    /// so it neither keeps a processor to itself nor makes the kernel end the process (RLIMIT_RTTIME).
    bool realtime = false;
    /// How long the stream stood still in each of the newest 64 xruns, oldest first; 0 where the device
    /// cannot tell.
    std::vector<double> xrun_s = {};
};

/// Where the stream is, for displays.
struct player_position {
    bool running = false;
    std::uint64_t played = 0;             ///< frame at the DAC
    std::optional<stroke_id> stroke = {}; ///< the newest that sounds
    std::uint64_t stroke_frame = 0;       ///< its frame at the DAC
};

/// Lines that the player drives or listens to; each may be empty.
struct player_lines {
    std::unique_ptr<enable_line> amplifier = {}; ///< on only while the stream is known to run
    double settle_s = 0.010;                     ///< turn-on time of the amplifier, spent in silence
    /// The DAC must have played so long before the amplifier goes on, s, 0 to 600; two periods at least. More
    /// is for a device that was lost: one that fails again at once then never switches the amplifier on.
    double proof_s = 0.0;
    std::unique_ptr<enable_line> sync_out = {}; ///< a pulse at each stroke's first sample at the DAC
    double pulse_s = 0.005;
    std::unique_ptr<edge_input> trigger = {}; ///< starts armed strokes
    double trigger_delay_s = 0.050;           ///< from the edge to the first sample at the DAC
};

/// The first tactor that cannot be played on a stream of this wiring, and why: its channel reaches no channel
/// of the device, or only channels that other tactors' channels reach, too, or it arrives there louder than
/// it was written, beyond its limit. Empty: there is no such tactor, or it cannot be known
/// (stream_wiring::hidden_by).
[[nodiscard]] TACTOR_API std::string lost_tactor(const array& a, const stream_wiring& w);

/// Sentences about tactors that are felt in another way than they were written: weaker, with their polarity
/// reversed, or through several channels of the device.
[[nodiscard]] TACTOR_API std::vector<std::string> wiring_warnings(const array& a, const stream_wiring& w);

/// Owns the sink, the audio thread and the control thread. Its members may be called from any thread but the
/// audio thread; they lock, so that several producers are safe. All numbers may be given: an impossible one
/// is an error, never a crash. Where memory runs out, std::bad_alloc comes through, and the call that failed
/// has done nothing; the player's own threads wait for memory and lose nothing.
///
/// Handlers (on_report(), on_end()) may call all members, and may destroy the player. A handler that throws
/// ends the stream: all strokes fade out and end interrupted. The reason in their reports is what the handler
/// threw; ended() gives it as well.
class TACTOR_API player {
public:
    /// Starts the stream with silence. `a` gives the limit of each channel.
    /// \throws error: not_available or runtime when the stream does not start, runtime too when there are not
    ///         enough descriptors or threads (it takes 7 to 9 descriptors), bad_input for options out of
    ///         range, no sink, a tactor on a channel that the stream does not have, and a trigger whose
    ///         descriptor cannot be polled.
    player(std::unique_ptr<sink> s, const array& a, const player_options& o = {}, player_lines lines = {});
    /// Calls stop() and closes the sink. When it returns, all strokes have been reported. This also holds in
    /// a handler: for the strokes that are left, the handlers are then called from within the destructor.
    ~player();
    player(const player&) = delete;
    player& operator=(const player&) = delete;

    [[nodiscard]] const stream_setup& setup() const noexcept;

    /// Plays a score as soon as possible, from a frame of the stream or a time on, or when triggered.
    /// Several may sound at once. Does not block: drives that do not fit into the ring wait on the control
    /// side. With N periods in the buffer, a score that starts now has its first sample in the device's
    /// buffer one period after this call at the latest, and at the DAC after N + 1 periods at the latest.
    /// A score that starts at a given time is punctual if this call is made N + 1 periods before it.
    /// \throws error: bad_input when rate or channels differ from the stream's, and for a score that the
    ///         player's array would not play in full: it drives a channel without a tactor there (a
    ///         continuous stroke counts for all tactors of its own array), it drives a tactor above its limit
    ///         there, or it has its marker on a tactor's channel; runtime when the stream has ended.
    stroke_id submit(const score& s, start_at start = start_at::now());

    /// Starts all armed strokes: their first samples are at the DAC at a CLOCK_MONOTONIC time, ns, or as
    /// soon as possible when that time has passed. Returns how many there were. An edge at the trigger
    /// line does the same, player_lines::trigger_delay_s after its own time. Does not block.
    std::size_t fire(std::int64_t monotonic_ns);
    template <detail::no_count T>
    std::size_t fire(T seconds) = delete;

    /// Begins a stroke that is fed point by point; it is silent until its first point, which must come within
    /// live_options::timeout_s. It ends in a report like all strokes. At most 64 sound at a time; further
    /// ones wait until one of them ends, and begin with their newest point. A stroke without a point does not
    /// count. \throws error: bad_input for options out of range (levels, carrier, SOA) and for Tactile Brush,
    /// runtime when the stream has ended.
    [[nodiscard]] live_stroke begin(const live_options& o = {});

    /// Fades a stroke out. One that waits (for its time, a trigger, the amplifier, a point) ends at once,
    /// while the system sleeps too. False when it has ended or is not known.
    bool cancel(stroke_id id);

    /// Blocks until the stroke has ended, for timeout_s at most where there is one, and returns how it ended.
    /// In a handler it does not block (reports come from the handler's own thread). Each report is given once
    /// by wait(), and to the handler when there is one. Of reports that nobody waits for, the 4096 newest are
    /// kept.
    wait_result wait(stroke_id id, std::optional<double> timeout_s = {});
    template <std::same_as<std::int64_t> T>
    wait_result wait(stroke_id id, T nanoseconds) = delete;

    /// Called in the control thread for each stroke that begins, soon after its first frame was handed to the
    /// device and before its report: with the CLOCK_MONOTONIC, ns, at which that frame is (or was) at the
    /// DAC, or nothing while the DAC's clock is not known. A stroke that an xrun cuts before its first sample
    /// sounds begins again, and is told of again. Set it before the first submit().
    void on_begin(std::function<void(stroke_id, std::optional<std::int64_t>)> handler);

    /// Called in the control thread for each ended stroke. Set it before the first submit().
    void on_report(std::function<void(const stroke_report&)> handler);

    /// Calls `done` once when a stroke has ended: in the control thread, or, if it has ended already, at once
    /// in this call, which then passes on what `done` throws. Returns false, without calling, for a stroke
    /// that is not known (any more). Several functions may be set for one stroke. See <tactor/asio.hpp> for
    /// completion tokens.
    /// \throws error (bad_input) for an empty function.
    [[nodiscard]] bool on_end(stroke_id id, std::function<void(const stroke_report&)> done);

    /// Fades all strokes out, plays silence until the fade has been played, and stops the stream. Strokes
    /// that this ends count as cancelled (interrupted, where the destructor does it). If the device's buffer
    /// is so long that strokes still sound after 0.4 s, they are cut then, after the amplifier went off.
    /// Returns when all this is done and reported; in a handler, it returns at once.
    void stop();

    /// How the stream has ended; nothing while it goes on. A stream that has ended does not start again: open
    /// the device anew (reopen_alsa()) for a new player.
    [[nodiscard]] std::optional<stream_end> ended() const;

    [[nodiscard]] player_position position() const noexcept;
    [[nodiscard]] player_stats stats() const;
    /// How long each channel was driven lately, for the next player on the array. Waits until the audio
    /// thread has ended.
    /// \throws error (runtime) while the stream goes on: stop() it first.
    [[nodiscard]] drive_history history() const;

private:
    struct impl;
    std::shared_ptr<impl> impl_; ///< the control thread's, too, while a handler runs
};

} // namespace v0
} // namespace tactor
