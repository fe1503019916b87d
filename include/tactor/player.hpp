// SPDX-License-Identifier: MIT
/// \file
/// The engine, which plays scores on a sink in real time. It also plays live strokes, which a program feeds
/// point by point while they sound, for example from a sensor, a finger or a simulation. The engine reports
/// how strokes and streams ended.
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

/// Way in which a submitted score ended. Each score ends in exactly one of these states.
enum class state_kind {
    finished,    ///< its last frame reached the DAC
    cancelled,   ///< faded out on request
    interrupted, ///< ended by an xrun, the loss of the device or a failure; live strokes also by a silent
                 ///< producer or by longest_s
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
    starved,   ///< no more points came within live_options::timeout_s
    too_long,  ///< the live stroke reached live_options::longest_s
    muted,     ///< the amplifier was off
    amplifier, ///< the amplifier's line cannot be switched
    left_on,   ///< the amplifier's line cannot be switched off: it may be on
    plan,      ///< live strokes: a custom phantom model failed, or returned an amplitude above the intensity
    handler,   ///< one of the program's handlers threw
};
TACTOR_KIND(reason_kind);

/// Delays of a live stroke's points. The delay of a point is the time from its time stamp until the first
/// frame that it changed was at the DAC. For the first point of a stroke, that frame was at the DAC at
/// stroke_report::started_ns. For each other point, the time at the DAC is predicted from the DAC's clock
/// when the point is rendered. Two kinds of points do not count: points in a stream's first periods, before
/// the DAC's clock is known, and points that a newer point replaced before the next period.
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
    std::uint64_t frames = 0;               ///< frames that were played, from the stroke's first on
    reason_kind reason = reason_kind::none; ///< reason of an interruption
    std::string why = {};                   ///< the reason in words, with further details
    /// Time from the requested start until the stroke's first sample was at the DAC; 0 if the stroke was in
    /// time, and for start_at::now().
    double late_s = 0.0;
    /// Time by CLOCK_MONOTONIC at which the stroke's first sample was at the DAC, from the DAC's clock while
    /// that sample passed. None if the stroke never sounded (`frames` is 0).
    std::optional<std::int64_t> started_ns = {};
    /// Frame of the stream with the stroke's first sample. None if the stroke never sounded.
    std::optional<std::uint64_t> first_frame = {};
    std::optional<live_delay> delay = {}; ///< live strokes only, after a point has sounded
    std::uint64_t held_points = 0;        ///< live strokes only: points above intensity 1, which sounded as 1
    std::uint64_t outside_points = 0;     ///< live strokes only: points outside the array, moved to its edge
    std::string doubt = {}; ///< live strokes only: likely unit of the points if they are not in mm
};

/// End of a stream.
struct stream_end {
    reason_kind reason = reason_kind::none; ///< none: stop() ended it in order
    std::string why = {};                   ///< the reason for people; empty for none
};

/// Outcome of a call of wait().
enum class wait_kind {
    ended,   ///< the stroke has ended, and its report is there
    timeout, ///< the stroke has not ended: the time-out passed, or the caller is a handler, in which wait()
             ///< does not block
    taken,   ///< the stroke has ended, but its report was returned before, or there were 4096 newer reports
    unknown, ///< this player never had such a stroke
};
TACTOR_KIND(wait_kind);

/// Result of wait(): the report, or the reason why there is none.
class [[nodiscard]] wait_result {
public:
    wait_result(wait_kind without) noexcept : outcome_(without) {}
    wait_result(stroke_report r) noexcept : outcome_(wait_kind::ended), report_(std::move(r)) {}

    [[nodiscard]] wait_kind outcome() const noexcept { return outcome_; }
    /// Returns true if there is a report. Without a report, `*` and `->` must not be used.
    explicit operator bool() const noexcept { return report_.has_value(); }
    const stroke_report& operator*() const noexcept { return *report_; }
    const stroke_report* operator->() const noexcept { return &*report_; }

private:
    wait_kind outcome_;
    std::optional<stroke_report> report_;
};

/// Options of a live stroke.
struct live_options {
    /// Options of the plan. With algorithm `continuous`, the carrier runs throughout and the phantom's
    /// weights follow the points. With `park2016`, a burst begins every SOA at the newest position. Only
    /// these members count:
    /// - `algorithm`, `scale` and `outside`;
    /// - `phantom` and `faces`, or `custom_phantom`;
    /// - `carrier_hz`, `am` and `wave` (but no recording along a length);
    /// - for bursts: `soa_s`, and `burst_s` or `profile`, which set the duration of a burst.
    plan_options plan{.algorithm = algorithm_kind::continuous, .outside = outside_kind::clamp};
    /// Levels, phase and the ramp of bursts. Rate and channels come from the stream.
    render_options render = {};
    /// Time-out, s, 0.001 to 86400. If no point comes for this time, the producer has failed: the stroke
    /// fades out and is reported as interrupted. The time-out also applies between player::begin() and the
    /// first point. Its time is counted in frames of the stream, so the count stops while the system sleeps.
    double timeout_s = 0.5;
    /// Longest time for which the stroke may sound, s, 0.001 to 86400, exact to a period. Then the stroke
    /// fades out and is reported as interrupted. None: no limit.
    std::optional<double> longest_s = {};
    /// Window over which points are smoothed, s, 0 (off) to 1. Use it for points that come in groups, for
    /// example over a network. Place and intensity are the mean of the points over the window that ends now.
    /// So the stroke moves evenly to each new point and reaches it one window after the point came. If the
    /// points move evenly, the stroke lags behind them by half the window. After end(), the stroke still
    /// moves to the last point.
    double smooth_s = 0.0;
};

/// Counts of a live stroke's points.
struct live_counts {
    std::uint64_t points = 0;  ///< accepted by to()
    std::uint64_t outside = 0; ///< accepted points that were moved to the nearest point of the array
    std::uint64_t limited = 0; ///< accepted points at which a tactor was held at its channel's limit
    std::uint64_t held = 0;    ///< accepted points with an intensity above 1, which sounded as 1
};

/// Handle with which a producer feeds a live stroke. Cheap to copy. All copies feed the same stroke, and a
/// move is a copy. The handle may outlive the player. Without end() or cancel(), or when no copy is left, the
/// stroke ends by its time-out (live_options::timeout_s). Any thread may call all members. No call waits for
/// the audio thread or the player. A call may wait for a microsecond for another call of to() on the same
/// stroke.
class TACTOR_API live_stroke {
public:
    [[nodiscard]] stroke_id id() const noexcept;

    /// Moves the stroke to a place, mm, at an intensity (linear; 1 is the requested level). That level is the
    /// ceiling: an intensity above 1 sounds as 1, and live_counts::held and stroke_report::held_points count
    /// such points. With outside_kind::clamp, a place outside the array becomes the nearest place on the
    /// array, and live_counts::outside and stroke_report::outside_points count such points. When several
    /// points arrive within one period, the newest counts.
    ///
    /// In a continuous stroke, the weights change from those of the last point to those of this point. The
    /// change begins with the next period that is written and takes one period, but at least
    /// continuous_step_s. The delay of the buffer adds to this time. In a stroke of bursts, the next burst
    /// plays at the new place, and starts within one SOA. With live_options::smooth_s, both kinds of stroke
    /// only begin to move to the point at these times.
    ///
    /// `at` is the time of the touch, from which stroke_report::delay counts. None: now. `at` does not change
    /// the time at which the stroke reaches the point.
    ///
    /// Returns false if the stroke has ended; its report says why. If the phantom model gives a tactor an
    /// amplitude above the intensity (after the intensity scale), the stroke ends and is reported as
    /// interrupted. The same happens if a custom phantom model throws anything but error (bad_input) and
    /// std::bad_alloc: the exception passes through, and the report has its what() as the reason.
    /// \throws error (bad_input) for a number that is not finite, for an intensity or a time stamp below 0,
    ///         for a point outside the array (with outside_kind::error), and for a point that a custom
    ///         phantom model refuses with error (bad_input). The stroke then stays where it was.
    /// \throws error (runtime) if a custom phantom model calls to() for the stroke that is calling the model.
    ///         The model may end or cancel that stroke, but must not wait for another thread that calls to().
    bool to(double x_mm, double y_mm, double intensity = 1.0, std::optional<monotonic_time> at = {});

    /// Announces that no more points come. A continuous stroke fades out; a stroke of bursts plays its last
    /// burst to the end. Then the stroke is reported as finished.
    void end() noexcept;
    /// Fades the stroke out, which is then reported as cancelled. Does the same as player::cancel().
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
    /// possible. If the stream never reaches that frame, the stroke waits until it is cancelled. After an
    /// xrun, the count of frames continues.
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
    /// Starts so that the first sample is at the DAC at this time, within half a frame plus the error of the
    /// DAC's clock. If the time has passed, the stroke starts as soon as possible; see stroke_report::late_s.
    /// Any time is valid.
    [[nodiscard]] static constexpr start_at time(monotonic_time t) noexcept
    {
        start_at s;
        s.kind_ = start_kind::time;
        s.time_ = t;
        return s;
    }
    /// Arms the stroke: it waits silently for an edge at player_lines::trigger or for player::fire(),
    /// whichever comes first.
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
    /// Lead time, s: the audio thread receives a drive this long before the drive is at the DAC. At least two
    /// buffers plus four periods.
    double horizon_s = 0.5;
    double fade_s = 0.010; ///< fade on cancel and stop
    /// Time for which the device's position may stand still, s, at least 16 periods. After this time the
    /// device counts as lost.
    double stall_s = 0.5;
    bool realtime = true;          ///< request SCHED_FIFO
    bool require_realtime = false; ///< throw instead of continuing without SCHED_FIFO
    int priority = 65;
    /// Limits on the power of all tactors and on the drive time of each, whatever the scores request.
    drive_limits limits = {};
    /// True: all players on the same device (stream_setup::device) share the drive time of each channel.
    /// These are earlier and present players, also in other processes of this user. So neither a new player
    /// nor a second process resets the drive time that a tactor has used. See player::drive_time_doubt().
    /// False: the drive time begins at 0 and is not stored.
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
    /// Number of times that the amplifier was switched off because the audio thread, or the whole process,
    /// stood still.
    std::uint64_t stalls = 0;
    /// Number of times that the amplifier's line could not be switched off. The player tries again for a
    /// second.
    std::uint64_t off_failures = 0;
    /// True if the line could not be switched off in all these tries, so that the amplifier may be on.
    /// player::ended() also reports this.
    bool left_on = false;
    std::uint64_t sync_pulses = 0; ///< pulses sent on player_lines::sync_out
    std::uint64_t sync_missed = 0; ///< pulses not sent, because their time had passed or the line failed
    double sync_mean_late_s = 0.0; ///< mean delay of a pulse after its frame, by the DAC's clock
    double sync_worst_late_s = 0.0;
    std::uint64_t ring_low_water = 0; ///< fewest drives that waited while a stroke played
    double latest_wakeup_s = 0.0;
    /// Page faults of the audio thread after its first wake-ups; 0 if memory is locked. Counted once a
    /// second.
    std::uint64_t minor_faults = 0;
    std::uint64_t major_faults = 0; ///< faults that had to wait for a disk
    /// True while the audio thread has SCHED_FIFO. The thread gives SCHED_FIFO up after some 0.1 s of work
    /// without a pause, so that it does not block a processor and the kernel does not end the process
    /// (RLIMIT_RTTIME).
    bool realtime = false;
    /// Time for which the stream stood still in each of the newest 64 xruns, oldest first; 0 if the device
    /// does not know.
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
    /// Time for which the DAC must play before the amplifier is switched on, s, 0 to 600; at least two
    /// periods. For a device that was lost, use a longer time: if the device fails again at once, the
    /// amplifier stays off.
    double proof_s = 0.0;
    std::unique_ptr<enable_line> sync_out = {}; ///< gives a pulse at each stroke's first sample at the DAC
    double pulse_s = 0.005;
    std::unique_ptr<edge_input> trigger = {}; ///< starts armed strokes
    double trigger_delay_s = 0.050;           ///< time from the edge to the first sample at the DAC
};

/// Returns the first tactor that cannot be played on a stream of this wiring, and the reason. Returns an
/// empty text if there is no such tactor, or if the wiring is not known (stream_wiring::hidden_by). There are
/// three reasons:
/// - the tactor's channel reaches no channel of the device;
/// - the tactor's channel reaches only channels that other tactors also reach;
/// - the wiring amplifies the tactor's samples above the tactor's limit.
[[nodiscard]] TACTOR_API std::string lost_tactor(const array& a, const stream_wiring& w);

/// Returns sentences about tactors whose samples change on the way to the device: they arrive weaker, with
/// reversed polarity or on several channels of the device, or ALSA may clip them (stream_wiring::most_gain).
[[nodiscard]] TACTOR_API std::vector<std::string> wiring_warnings(const array& a, const stream_wiring& w);

/// Returns the reason why this process cannot share the drive time of a device (stream_setup::device) with
/// other processes; empty: it can. Processes share drive time in a file of the folder `tactor` in the runtime
/// folder (RUNTIME_DIRECTORY, else XDG_RUNTIME_DIR), which must belong to this user alone. Tests the file by
/// writing its present contents again. Without a file, only players of this process share drive time. Blocks
/// for 0.2 s at most. Reads the environment. Any thread.
[[nodiscard]] TACTOR_API std::string drive_time_fault(std::string_view device);

/// Owner of the sink, the audio thread and the control thread. Any thread except the audio thread may call
/// the members, which lock, so several producers are safe. An impossible number causes an error, never a
/// crash. When memory runs out, std::bad_alloc passes through, and the failed call has no effect. The
/// player's own threads wait for memory and lose nothing.
///
/// Handlers (on_report(), on_end()) may call all members and may destroy the player. If a handler throws, the
/// stream ends: all strokes fade out and are reported as interrupted. Their reports and ended() have the text
/// of the exception.
class TACTOR_API player {
public:
    /// Starts the stream with silence. `a` sets the limit of each channel.
    /// \throws error (not_available or runtime) if the stream does not start.
    /// \throws error (runtime) if threads or descriptors run out; a player takes 3 or 4 descriptors.
    /// \throws error (bad_input) for options out of range, for no sink, for a sink whose setup() has no rate,
    ///         no channels, no period or a buffer below one period, for a tactor on a channel that the stream
    ///         does not have, and for a trigger whose descriptor is not open.
    player(std::unique_ptr<sink> s, const array& a, const player_options& o = {}, player_lines lines = {});
    /// Calls stop() and closes the sink. When the destructor returns, all strokes have been reported. This is
    /// also true inside a handler: the destructor then calls the handlers for the remaining strokes itself.
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
    /// most one period after this call, and at the DAC at most N + 1 periods after it. A score with a given
    /// start time is punctual if this call comes N + 1 periods before that time. `level_db` is the level at
    /// the start, see set_level().
    /// \throws error (bad_input) if rate or channels differ from the stream's.
    /// \throws error (bad_input) if the player's array cannot play the whole score, because the score drives
    ///         a channel without a tactor in this array, drives a tactor above its limit, or has its marker
    ///         on a tactor's channel. A continuous stroke counts as driving all tactors of the score's array.
    /// \throws error (runtime) if the stream has ended.
    stroke_id submit(const score& s, start_at start = start_at::now(), double level_db = 0.0);

    /// Changes the level of a stroke, planned or live, within 20 ms from the next period on. `db` is relative
    /// to the stroke's own level, -60 to 0 dB, so the stroke never gets stronger than it was designed. A
    /// stroke begins at 0 dB unless submit() sets another level. Returns false if the stroke has ended or is
    /// not known. Does not block.
    /// \throws error (bad_input) for a level outside this range.
    bool set_level(stroke_id id, double db);

    /// Returns the frame of the stream at which a planned stroke began. Returns nothing unless the stroke
    /// sounds now. To continue the stroke without a gap, start another stroke with start_at::frame() at this
    /// frame plus the length of the first stroke.
    [[nodiscard]] std::optional<std::uint64_t> first_frame(stroke_id id) const;

    /// Starts all armed strokes so that their first samples are at the DAC at time `t`, or as soon as
    /// possible if `t` has passed. Returns the number of these strokes. An edge at the trigger line also
    /// starts all armed strokes, player_lines::trigger_delay_s after the time of the edge. Does not block.
    std::size_t fire(monotonic_time t);

    /// Begins a stroke that the program feeds point by point. It is silent until its first point, which must
    /// come within live_options::timeout_s. When it ends, the player reports it like every stroke. At most 64
    /// live strokes sound at a time; strokes without a point do not count. Further strokes wait until one of
    /// the 64 ends, and begin with their newest point.
    /// \throws error (bad_input) for options out of range (levels, carrier, SOA) and for Tactile Brush.
    /// \throws error (runtime) if the stream has ended.
    [[nodiscard]] live_stroke begin(const live_options& o = {});

    /// Fades a stroke out. A stroke that waits (for its time, a trigger, the amplifier, a point) ends at
    /// once, even while the system sleeps. Returns false if the stroke has ended or is not known.
    bool cancel(stroke_id id);
    /// Cancels all strokes at once. Returns true if the stream continues. If the device's buffer is longer
    /// than 0.4 s, fades would come too late: the stream then ends as after stop(), and this call returns
    /// false without waiting. It also returns false after stop() and when the stream has ended.
    bool cancel_all();

    /// Blocks until the stroke has ended, at most for `timeout` if it is given, and returns how it ended. In
    /// a handler wait() does not block, because the thread that runs the handler also makes the reports.
    /// wait() returns each report once, even if a handler also receives the report. The player keeps the 4096
    /// newest reports for which nobody waits.
    wait_result wait(stroke_id id, std::optional<std::chrono::duration<double>> timeout = {});

    /// Sets a handler that the control thread calls for each stroke that begins, soon after the stroke's
    /// first frame went to the device, or up to half a second before if the stroke has a start time, and
    /// before the stroke's report. The handler receives the CLOCK_MONOTONIC time in ns at which that frame is
    /// (or was) at the DAC, or nothing while the DAC's clock is not known. If an xrun cuts a stroke before
    /// its first sample sounds, the stroke begins again and the handler is called again. Set the handler
    /// before the first submit().
    void on_begin(std::function<void(stroke_id, std::optional<std::int64_t>)> handler);

    /// Sets a handler that the control thread calls for each ended stroke. Set the handler before the first
    /// submit().
    void on_report(std::function<void(const stroke_report&)> handler);

    /// Calls `done` once when a stroke has ended. The control thread makes this call. If the stroke has ended
    /// already, on_end() itself calls `done` at once, and exceptions of `done` pass through. Returns false
    /// and does not call `done` if the stroke is not known, or no longer known. A stroke may have several
    /// such functions. See <tactor/asio.hpp> for completion tokens.
    /// \throws error (bad_input) for an empty function.
    [[nodiscard]] bool on_end(stroke_id id, std::function<void(const stroke_report&)> done);

    /// Fades all strokes out, plays silence until the fade is over, and stops the stream. The strokes are
    /// reported as cancelled, or as interrupted if the destructor stops them. If the device's buffer is so
    /// long that strokes still sound after 0.4 s, the amplifier is switched off and then the strokes are cut.
    /// Returns when all this is done and reported; in a handler, returns at once.
    void stop();

    /// Returns how the stream ended, or nothing while it runs. A stream that has ended does not start again:
    /// open the device again (reopen_alsa()) for a new player.
    [[nodiscard]] std::optional<stream_end> ended() const;

    [[nodiscard]] player_position position() const noexcept;

    /// Returns the drive time, s, that each channel had when the stream began, because of earlier players and
    /// other programs on the device; see drive_limits::max_drive_s. Empty without
    /// player_options::keep_drive_time.
    [[nodiscard]] std::vector<double> drive_levels_s() const;
    /// Returns why the drive time may be incomplete; empty if it is complete. If the file of drive times
    /// cannot be written, the next run does not know the drive time of this run. If the file cannot be read
    /// as a whole, or another program keeps it locked for 0.2 s, the drive time of each tactor begins at
    /// drive_limits::max_drive_s. Keeps the first reason, which player_options::log also receives.
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
