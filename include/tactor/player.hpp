// SPDX-License-Identifier: MIT
/// \file
/// The engine. It plays scores on a sink in real time. It also plays strokes that a program feeds point by
/// point while they sound, from a sensor, a finger or a simulation. It reports how strokes and streams ended.
#pragma once

#include <chrono>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/lines.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/sink.hpp>

namespace tactor {
inline namespace v0 {

/// A time of CLOCK_MONOTONIC, to the nanosecond.
using monotonic_time = std::chrono::steady_clock::time_point;

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
    plan,      ///< live strokes: a custom phantom model failed, or returned more than the intensity
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
    std::string doubt = {}; ///< live strokes only: likely unit of its points, if not millimetres
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
class [[nodiscard]] wait_result {
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

/// Options of a live stroke.
struct live_options {
    /// These members count: `algorithm`, `phantom` and `faces`, or `custom_phantom`, `carrier_hz`, `wave` (no
    /// recording along a length), `am`, `scale`, `outside`; for bursts also `soa_s`, and `burst_s` or
    /// `profile`, which give their duration. Algorithm continuous: the carrier runs and the phantom's weights
    /// follow the points. Algorithm park2016: each SOA has a burst at the newest position.
    plan_options plan{.algorithm = algorithm_kind::continuous, .outside = outside_kind::clamp};
    /// Levels, phase and the bursts' ramp. Rate and channels are the stream's.
    render_options render = {};
    /// Time-out, s, 0.001 to 86400. A producer that is silent for so long has failed: the stroke fades out
    /// and ends interrupted. The time counts from player::begin() on, also before the first point. It counts
    /// frames of the stream, so it stops while the system sleeps.
    double timeout_s = 0.5;
    /// Longest time that the stroke may sound, s, 0.001 to 86400, exact to a period. Then it fades out and
    /// ends interrupted. None: no limit.
    std::optional<double> longest_s = {};
    /// Window over which points are smoothed, s, 0 (off) to 1. It is for points that come in bursts, as over
    /// a network. Place and intensity are the mean of the points over the window that ends now. So the stroke
    /// moves evenly to each new point and reaches it one window after the point came. Behind points that move
    /// evenly it is late by half the window. end() waits until the stroke has reached the last point.
    double smooth_s = 0.0;
};

/// Counts of a live stroke's points.
struct live_counts {
    std::uint64_t points = 0;  ///< accepted by to()
    std::uint64_t outside = 0; ///< of these, points that were moved to the nearest point of the array
    std::uint64_t limited = 0; ///< of these, points at which a tactor was held at its channel's limit
    std::uint64_t held = 0;    ///< of these, points with an intensity above 1, which sounded as 1
};

/// The producer's end of a live stroke. Cheap to copy. All copies feed the same stroke, and a move is a copy.
/// It may outlive the player. Without end() or cancel(), or when no copy is left, the stroke ends by its
/// time-out (live_options::timeout_s). Any thread may call all members. No call waits for the audio thread or
/// the player; a call may wait (for a microsecond) for another call of to() on the same stroke.
class TACTOR_API live_stroke {
public:
    [[nodiscard]] stroke_id id() const noexcept;

    /// Moves the stroke to a place, mm, at an intensity (linear; 1 is the requested level). That level is the
    /// ceiling: an intensity above 1 sounds as 1, and live_counts::held and stroke_report::held_points count
    /// it. A place outside the array becomes the nearest one in it (outside_kind::clamp), and
    /// live_counts::outside and stroke_report::outside_points count it. When several points arrive within one
    /// period, the newest counts.
    ///
    /// Continuous: with the next period that is written, the weights begin to move from the last point's to
    /// this one's. The move takes one period, at least continuous_step_s. The buffer's delay adds to this.
    /// Bursts: the next burst has this place. It starts at most one SOA later. With live_options::smooth_s,
    /// both begin at that time to move there.
    ///
    /// `at`: time of the touch; stroke_report::delay counts from it. None: now. It does not change when the
    /// stroke gets there.
    ///
    /// Returns false if the stroke has ended; its report says why. If the phantom model gives a tactor more
    /// than the intensity (after the intensity scale), the stroke ends interrupted.
    /// \throws error (bad_input) for a number that is not finite, an intensity or a time stamp below 0, a
    ///         point outside the array (with outside_kind::error), and a point that a custom phantom model
    ///         refuses with that error. The stroke then stays where it was. Other exceptions of such a model
    ///         pass through, too, and the stroke ends interrupted, with what() as its reason; std::bad_alloc
    ///         does not end it. error (runtime) if such a model calls this for the stroke that asks it. The
    ///         model may end or cancel that stroke, but must not wait for another thread that calls this.
    bool to(double x_mm, double y_mm, double intensity = 1.0, std::optional<monotonic_time> at = {});

    /// Announces that no more points come. The stroke fades out (continuous) or plays its last burst to the
    /// end, and ends finished.
    void end() noexcept;
    /// Fades the stroke out; it ends cancelled. The same as player::cancel().
    void cancel() noexcept;

    /// Returns true while the stroke accepts points.
    [[nodiscard]] bool open() const noexcept;
    [[nodiscard]] live_counts counts() const noexcept;

    live_stroke(const live_stroke&) noexcept = default;
    live_stroke& operator=(const live_stroke&) noexcept = default;

    struct impl;

private:
    friend struct detail::access;
    explicit live_stroke(std::shared_ptr<impl> p) noexcept;

    std::shared_ptr<impl> impl_;
};

/// Event for which a stroke's start waits.
enum class start_kind { frame, time, trigger };
TACTOR_KIND(start_kind);

/// Start of a stroke. A plain value.
class start_at {
public:
    /// Starts with the next period that is written.
    [[nodiscard]] static constexpr start_at now() noexcept { return {}; }
    /// Starts at a frame of the stream. If that frame has been written already, the stroke starts as soon as
    /// possible. If it never comes, the stroke waits until it is cancelled. The frame count continues over an
    /// xrun.
    /// \throws error (bad_input) for a negative frame.
    [[nodiscard]] static constexpr start_at frame(std::integral auto stream_frame)
    {
        if constexpr (std::signed_integral<decltype(stream_frame)>)
            if (stream_frame < 0)
                refuse_frame(stream_frame);
        start_at s;
        s.frame_ = static_cast<std::uint64_t>(stream_frame);
        return s;
    }
    /// Starts so that the first sample is at the DAC at this time, within half a frame and the error of the
    /// DAC clock. If the time has passed, the stroke starts as soon as possible; see stroke_report::late_s.
    /// Any time is valid.
    [[nodiscard]] static constexpr start_at time(monotonic_time t) noexcept
    {
        start_at s;
        s.kind_ = start_kind::time;
        s.time_ = t;
        return s;
    }
    /// Arms the stroke: it waits silently for an edge at player_lines::trigger or for player::fire(),
    /// whichever is first.
    [[nodiscard]] static constexpr start_at trigger() noexcept
    {
        start_at s;
        s.kind_ = start_kind::trigger;
        return s;
    }

    [[nodiscard]] constexpr start_kind what() const noexcept { return kind_; }
    [[nodiscard]] constexpr std::uint64_t stream_frame() const noexcept { return frame_; }
    [[nodiscard]] constexpr monotonic_time when() const noexcept { return time_; }

private:
    constexpr start_at() noexcept = default;
    [[noreturn]] TACTOR_API static void refuse_frame(long long stream_frame);

    start_kind kind_ = start_kind::frame;
    std::uint64_t frame_ = 0;
    monotonic_time time_ = {};
};

/// Options of a player.
struct player_options {
    /// Time by which drives reach the audio thread ahead of the DAC, s; two buffers and four periods at
    /// least.
    double horizon_s = 0.5;
    double fade_s = 0.010; ///< fade on cancel and stop
    /// Time for which the device's position may stand still, s, 16 periods at least. After that the device
    /// counts as lost.
    double stall_s = 0.5;
    bool realtime = true;          ///< request SCHED_FIFO
    bool require_realtime = false; ///< \throws instead of continuing without SCHED_FIFO
    int priority = 65;
    /// Limits on the power of all tactors and on the drive time of each, whatever the scores request.
    drive_limits limits = {};
    /// The drive time of each channel counts together with that of all players on the same device
    /// (stream_setup::device), earlier ones and those that play now, also of other processes of this user. So
    /// neither a new player nor a second process gives a tactor its used drive time back. See
    /// player::drive_time_doubt(). False: it begins at 0 and is not stored.
    bool keep_drive_time = true;
    /// Receives messages about the stream's start and end, xruns and recovery, mutes of the amplifier, and
    /// limits that acted.
    log_function log = {};
};

/// Counters since the player was opened.
struct player_stats {
    std::uint64_t periods = 0;
    std::uint64_t frames = 0; ///< frames written
    std::uint64_t xruns = 0;
    std::uint64_t limited_frames = 0;       ///< samples that a channel's own limit changed
    std::uint64_t power_limited_frames = 0; ///< frames in which drive_limits::power_dbfs acted
    std::uint64_t drives_cut = 0;           ///< drives cut short or silenced by drive_limits::max_drive_s
    /// Times that the amplifier was switched off because the audio thread, or the whole process, stood still.
    std::uint64_t stalls = 0;
    /// Times that the amplifier's line could not be switched off. The player tries again for a second.
    std::uint64_t off_failures = 0;
    /// The line could not be switched off in all these tries, so the amplifier may be on. player::ended()
    /// reports it, too.
    bool left_on = false;
    std::uint64_t sync_pulses = 0; ///< sent on player_lines::sync_out
    std::uint64_t sync_missed = 0; ///< pulses not sent, because their time was over or the line failed
    double sync_mean_late_s = 0.0; ///< delay of the line after the frame's time by the DAC clock
    double sync_worst_late_s = 0.0;
    std::uint64_t ring_low_water = 0; ///< fewest drives that waited while a stroke played
    double latest_wakeup_s = 0.0;
    /// Page faults of the audio thread after its first wake-ups; 0 if memory is locked. Counted once a
    /// second.
    std::uint64_t minor_faults = 0;
    std::uint64_t major_faults = 0; ///< faults that had to wait for a disk
    /// The audio thread has SCHED_FIFO. It gives SCHED_FIFO up after some 0.1 s of work without a pause, so
    /// that it neither blocks a processor nor makes the kernel end the process (RLIMIT_RTTIME).
    bool realtime = false;
    /// Time that the stream stood still in each of the newest 64 xruns, oldest first; 0 if the device cannot
    /// tell.
    std::vector<double> xrun_s = {};
};

/// Position of the stream, for displays.
struct player_position {
    bool running = false;
    std::uint64_t played = 0;             ///< frame at the DAC
    std::optional<stroke_id> stroke = {}; ///< newest stroke that sounds
    std::uint64_t stroke_frame = 0;       ///< frame of this stroke at the DAC
};

/// Lines that the player drives or watches. Each may be empty.
struct player_lines {
    std::unique_ptr<enable_line> amplifier = {}; ///< on only while the stream is known to run
    double settle_s = 0.010;                     ///< turn-on time of the amplifier, spent in silence
    /// Time that the DAC must play before the amplifier goes on, s, 0 to 600; two periods at least. Use a
    /// longer time for a device that was lost: if it fails again at once, the amplifier stays off.
    double proof_s = 0.0;
    std::unique_ptr<enable_line> sync_out = {}; ///< gives a pulse at each stroke's first sample at the DAC
    double pulse_s = 0.005;
    std::unique_ptr<edge_input> trigger = {}; ///< starts armed strokes
    double trigger_delay_s = 0.050;           ///< time from the edge to the first sample at the DAC
};

/// Returns the first tactor that cannot be played on a stream of this wiring, and why: its channel reaches no
/// channel of the device, or only channels that other tactors reach, too, or it arrives above its limit
/// because the wiring amplifies it. Empty if there is no such tactor, or if the wiring is not known
/// (stream_wiring::hidden_by).
[[nodiscard]] TACTOR_API std::string lost_tactor(const array& a, const stream_wiring& w);

/// Returns sentences about tactors that arrive changed: weaker, with reversed polarity, through several
/// channels of the device, or clipped on the way (stream_wiring::most_gain).
[[nodiscard]] TACTOR_API std::vector<std::string> wiring_warnings(const array& a, const stream_wiring& w);

/// Returns the reason why this process cannot share the drive time of a device (stream_setup::device) with
/// other processes; empty: it can. They share it in a file of the folder `tactor` in the runtime folder
/// (RUNTIME_DIRECTORY, else XDG_RUNTIME_DIR), which must belong to this user alone. Tests this by writing the
/// file's present contents again. Without a file, only players of this process share drive time. Blocks for
/// 0.2 s at most. Any thread that reads the environment.
[[nodiscard]] TACTOR_API std::string drive_time_fault(std::string_view device);

/// Owner of the sink, the audio thread and the control thread. Any thread but the audio thread may call its
/// members. They lock, so several producers are safe. An impossible number gives an error, never a crash.
/// When memory runs out, std::bad_alloc passes through and the failed call has no effect; the player's own
/// threads wait for memory and lose nothing.
///
/// Handlers (on_report(), on_end()) may call all members and may destroy the player. If a handler throws, the
/// stream ends: all strokes fade out and end interrupted. Their reports and ended() give the text of the
/// exception.
class TACTOR_API player {
public:
    /// Starts the stream with silence. `a` gives the limit of each channel.
    /// \throws error: not_available or runtime if the stream does not start; runtime if descriptors (it takes
    ///         3 or 4) or threads run out; bad_input for options out of range, no sink, a sink whose setup()
    ///         has no rate, no channels, no period or a buffer below one period, a tactor on a channel that
    ///         the stream does not have, and a trigger whose descriptor is not open.
    player(std::unique_ptr<sink> s, const array& a, const player_options& o = {}, player_lines lines = {});
    /// Calls stop() and closes the sink. When it returns, all strokes have been reported. This also holds in
    /// a handler: the destructor then calls the handlers for the remaining strokes itself.
    ~player();
    player(const player&) = delete;
    player& operator=(const player&) = delete;

    [[nodiscard]] const stream_setup& setup() const noexcept;

    static constexpr double least_level_db =
        -60.0; ///< lower bound of the levels of submit() and set_level(), dB

    /// Plays a score as soon as possible, from a frame or a time on, or when triggered. Several scores may
    /// sound at once. Does not block: drives that do not fit into the ring wait on the control side.
    ///
    /// With N periods in the buffer, the first sample of a score that starts now is in the device's buffer at
    /// most one period after this call, and at the DAC after at most N + 1 periods. A score that starts at a
    /// given time is punctual if this call comes N + 1 periods before it. `level_db`: as set_level().
    /// \throws error: bad_input if rate or channels differ from the stream's, or if the player's array cannot
    ///         play the whole score: it drives a channel without a tactor there (a continuous stroke counts
    ///         for all tactors of the score's array), it drives a tactor above its limit there, or it has its
    ///         marker on a tactor's channel; runtime if the stream has ended.
    stroke_id submit(const score& s, start_at start = start_at::now(), double level_db = 0.0);

    /// Changes the level of a stroke, planned or live, within 20 ms from the next period on. `db` is relative
    /// to the stroke's own level, -60 to 0 dB, so it never gets stronger than it was designed. It begins at 0
    /// dB unless submit() sets another level. Returns false if the stroke has ended or is not known. Does not
    /// block.
    /// \throws error (bad_input) for another level.
    bool set_level(stroke_id id, double db);

    /// Returns the frame of the stream with which a planned stroke began, while it sounds; nothing before and
    /// after that. To continue the stroke without a gap, start another one with start_at::frame() at this
    /// frame plus the stroke's length.
    [[nodiscard]] std::optional<std::uint64_t> first_frame(stroke_id id) const;

    /// Starts all armed strokes: their first samples are at the DAC at a time, or as soon as possible if that
    /// time has passed. Returns the number of strokes. An edge at the trigger line does the same,
    /// player_lines::trigger_delay_s after its own time. Does not block.
    std::size_t fire(monotonic_time t);

    /// Begins a stroke that the program feeds point by point. It is silent until its first point, which must
    /// come within live_options::timeout_s. It ends in a report like every stroke. At most 64 such strokes
    /// sound at a time, not counting those without a point. Further ones wait until one of them ends, and
    /// begin with their newest point.
    /// \throws error: bad_input for options out of range (levels, carrier, SOA) and for Tactile Brush;
    ///         runtime if the stream has ended.
    [[nodiscard]] live_stroke begin(const live_options& o = {});

    /// Fades a stroke out. A stroke that waits (for its time, a trigger, the amplifier, a point) ends at
    /// once, even while the system sleeps. Returns false if the stroke has ended or is not known.
    bool cancel(stroke_id id);
    /// Cancels all strokes at once. Returns true if the stream goes on. In a device's buffer of more than 0.4
    /// s the fades would come too late: there the stream ends as by stop(), and this call returns false
    /// without waiting. It also returns false after stop() and when the stream has ended.
    bool cancel_all();

    /// Blocks until the stroke has ended, at most for `timeout` if it is given, and returns how it ended. In
    /// a handler it does not block, because reports come from the handler's own thread. wait() returns each
    /// report once; the handler, if any, gets it as well. Of reports for which nobody waits, the 4096 newest
    /// are kept.
    wait_result wait(stroke_id id, std::optional<std::chrono::duration<double>> timeout = {});

    /// Sets a handler that the control thread calls for each stroke that begins, soon after its first frame
    /// went to the device and before its report. It gets the CLOCK_MONOTONIC time, ns, at which that frame is
    /// (or was) at the DAC, or nothing while the DAC's clock is not known. If an xrun cuts a stroke before
    /// its first sample sounds, the stroke begins again and the handler is called again. Set it before the
    /// first submit().
    void on_begin(std::function<void(stroke_id, std::optional<std::int64_t>)> handler);

    /// Sets a handler that the control thread calls for each ended stroke. Set it before the first submit().
    void on_report(std::function<void(const stroke_report&)> handler);

    /// Calls `done` once when a stroke has ended: in the control thread, or at once in this call if it has
    /// ended already. In that case exceptions of `done` pass through. Returns false, without a call, for a
    /// stroke that is not known (any more). A stroke may have several such functions. See <tactor/asio.hpp>
    /// for completion tokens.
    /// \throws error (bad_input) for an empty function.
    [[nodiscard]] bool on_end(stroke_id id, std::function<void(const stroke_report&)> done);

    /// Fades all strokes out, plays silence until the fade is over, and stops the stream. The strokes end
    /// cancelled (interrupted, if the destructor stops them). If the device's buffer is so long that strokes
    /// still sound after 0.4 s, the amplifier goes off and then they are cut. Returns when all this is done
    /// and reported; in a handler, it returns at once.
    void stop();

    /// Returns how the stream ended, or nothing while it runs. A stream that has ended does not start again:
    /// open the device anew (reopen_alsa()) for a new player.
    [[nodiscard]] std::optional<stream_end> ended() const;

    [[nodiscard]] player_position position() const noexcept;

    /// Returns the drive time that earlier players and other programs had left on the device when the stream
    /// began, s, by channel; see drive_limits::max_drive_s. Empty without player_options::keep_drive_time.
    [[nodiscard]] std::vector<double> drive_levels_s() const;
    /// Returns why the drive time may be incomplete; empty if it is not. If the file cannot be written, the
    /// next run does not know this drive time. If it cannot be read as a whole, or another program keeps it
    /// locked for 0.2 s, each tactor counts as driven for as long as allowed. Keeps the first reason.
    /// player_options::log gets it, too.
    [[nodiscard]] std::string drive_time_doubt() const;
    [[nodiscard]] player_stats stats() const;

private:
    struct impl;
    std::shared_ptr<impl> impl_; ///< shared with the control thread while a handler runs
};

} // namespace v0
} // namespace tactor

template <>
struct std::hash<tactor::stroke_id> {
    std::size_t operator()(tactor::stroke_id id) const noexcept { return id.number; }
};
