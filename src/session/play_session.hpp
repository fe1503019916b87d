// SPDX-License-Identifier: MIT
/// \file
/// A run on a device: players one after the other on one device, as often as that is lost and comes back.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <tactor/tactor.hpp>

#include "rt/event_fd.hpp"
#include "session/device.hpp"
#include "session/interrupt.hpp"
#include "session/kept_drive.hpp"
#include "session/lines.hpp"
#include "session/log.hpp"

namespace tactor::session {

/// Adds a further player's counters.
void add_stats(player_stats& sum, const player_stats& more);

/// Returns what there is to say, before all else, of an amplifier that may be on.
std::optional<error> left_on(const player_stats& s);

/// Warns on standard error where tactors were driven for too long.
void warn_of_cuts(const drive_limits& l, const player_stats& s);

/// Points of a live stroke, from whatever gives them. One thread.
class point_source {
public:
    point_source() = default;
    virtual ~point_source() = default;
    point_source(const point_source&) = delete;
    point_source& operator=(const point_source&) = delete;

    /// Returns the next place that has come, mm, and its intensity; nothing where there is none yet, and at
    /// the end. Does not wait. \throws error (bad_input).
    virtual std::optional<timed_point> next() = 0;
    /// Returns true once no more will come, and all that came was given.
    virtual bool over() const noexcept = 0;
    /// Returns a descriptor that is readable when something has come.
    virtual int descriptor() const noexcept = 0;
    /// Says that the stroke holds the intensity of the newest point at 1.
    virtual void warn_of_held(double intensity) const = 0;
};

/// What a run has to report in the end, but for its strokes.
struct run_facts {
    stream_setup device = {};
    player_stats stats = {}; ///< of all players of the run together
    unsigned reopened = 0;
    bool locked_memory = false;
};

/// How a run comes to its stream: tests have devices of their own.
struct stream_source {
    std::function<std::unique_ptr<sink>(const alsa_options&)> open = open_device;
    player_options player = {};
};

class play_session {
public:
    /// Opens lines and device, settles real time and starts the stream. \throws error.
    play_session(const alsa_options& device, const stream_options& o, const environment& e,
                 stream_source source = {});
    ~play_session();
    play_session(const play_session&) = delete;
    play_session& operator=(const play_session&) = delete;

    const stream_setup& setup() const noexcept { return setup_; }
    /// What the constructor was given.
    const stream_options& asked() const noexcept { return options_; }

    /// Called some 25 times a second while a score is played: where the stream is, or null while the score
    /// does not sound.
    using watcher = std::function<void(const player_position*)>;

    /// Hands a score to the stream. With stream_options::arm it waits for the trigger instead of `start`.
    /// Returns a report where the stream has ended, else nothing. \throws error.
    std::optional<stroke_report> submit(const score& s, start_at start = start_at::now());
    /// Follows what was submitted to its end, or until a signal comes, see signal().
    stroke_report follow(const watcher& watch = {});
    /// Plays a score to its end, as submit() and follow(). \throws error.
    stroke_report play(const score& s, const watcher& watch, start_at start);
    /// Fades out what plays: for the watcher.
    void cancel();

    /// Plays a stroke that points move, until they end. \throws error, and what the points throw.
    stroke_report live(const live_options& o, point_source& points);

    /// Whether the device is gone, or failed: nothing can be played until reopen().
    bool lost() const { return player_ == nullptr || player_->ended().has_value(); }
    /// Whether a lost device is waited for.
    bool waits() const noexcept { return options_.reopen_s > 0.0; }
    /// Waits for the device, for as long as stream_options::reopen_s. False when it did not come back, or a
    /// signal came.
    bool reopen();

    /// Waits until a descriptor (or none: -1) can be read, or the time is over. False when a signal has come.
    bool wait_for(int descriptor, int timeout_ms = -1) { return sleep(descriptor, timeout_ms); }

    /// Where the stream is; of its own numbering, from 0 after each opening.
    player_position position() const;
    /// Counters of all streams up to now.
    player_stats stats() const;
    bool locked_memory() const noexcept { return locked_; }

    /// The signal that asked to end, or 0.
    int signal() const noexcept { return signal_; }

    /// Ends the stream in silence and returns what came of it.
    run_facts finish();
    /// Ends the stream in silence and warns of tactors that limits cut off. \throws error where the amplifier
    /// may be on.
    void end();

private:
    void start(std::unique_ptr<sink> s, double proof_s = 0.0);
    void close_player();
    bool try_again(const std::function<bool(double)>& pause);
    /// True if the amplifier may be on although its line was switched off: do not open again then.
    bool may_be_on() const { return player_ != nullptr && player_->stats().left_on; }
    /// False when a signal has come.
    bool sleep(int fd, int timeout_ms, int also = -1);
    stroke_report last_report(stroke_id id);
    /// Ends the player's stream, and keeps what it gave the array.
    void end_stream();

    stream_options options_;
    const environment& environment_;
    stream_source source_;
    interrupt stop_;
    rt::event_fd news_;               ///< a stroke has begun or ended
    std::atomic<bool> begun_ = false; ///< the latest stroke
    lent_lines lines_;
    session_log log_;
    alsa_options device_;
    stream_setup setup_;
    std::unique_ptr<player> player_;
    stroke_id playing_ = {};
    player_stats before_; ///< of the players before this one
    kept_drive kept_;     ///< what they gave the array lately, and runs before
    bool streams_ = false;
    unsigned reopened_ = 0;
    bool locked_ = false;
    int signal_ = 0;
};

} // namespace tactor::session
