// SPDX-License-Identifier: MIT
/// \file
/// A run of `play`: players one after the other on one device, as often as that is lost and comes back.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <tactor/tactor.hpp>

#include "cli/interrupt.hpp"
#include "cli/play/live_lines.hpp"
#include "cli/play/live_picture.hpp"
#include "cli/play/open_device.hpp"
#include "cli/play/play_lines.hpp"
#include "cli/play/play_log.hpp"
#include "cli/play/play_options.hpp"
#include "cli/play/play_report.hpp"
#include "cli/session/kept_drive.hpp"
#include "rt/event_fd.hpp"

namespace tactor::cli {

/// How a run comes to its stream: tests have devices of their own.
struct stream_source {
    std::function<std::unique_ptr<sink>(const alsa_options&)> open = open_device;
    player_options player = {};
};

class play_session {
public:
    /// Opens lines and device, settles real time and starts the stream. \throws error.
    play_session(const alsa_options& device, const play_options& o, const environment& e,
                 stream_source source = {});
    ~play_session();
    play_session(const play_session&) = delete;
    play_session& operator=(const play_session&) = delete;

    const stream_setup& setup() const noexcept { return setup_; }

    /// Told some 25 times a second where the stream is while the piece sounds, instead of a picture.
    using watcher = std::function<void(const player_position&)>;

    /// Plays one piece to its end, or until a signal comes, see signal(). With --arm it waits for the trigger
    /// instead of `start`. \throws error.
    stroke_report play(const piece& p, const score& s, const watcher& watch = {},
                       start_at start = start_at::now());
    /// Fades out what plays: for the watcher.
    void cancel();

    /// The same for a stroke that lines move, until they end.
    stroke_report live(const live_options& o, live_lines& lines);

    /// Whether the device is gone, or failed: nothing can be played until reopen().
    bool lost() const { return player_ == nullptr || player_->ended().has_value(); }
    /// Whether a lost device is waited for.
    bool waits() const noexcept { return options_.reopen_s > 0.0; }
    /// Waits for the device, as long as --reopen-s says. False when it did not come back, or a signal came.
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

    /// Ends the stream in silence; its part of the report.
    void finish(run_report& r);

private:
    void start(std::unique_ptr<sink> s, double proof_s = 0.0);
    void close_player();
    bool try_again(const std::function<bool(double)>& pause);
    /// True if the amplifier may be on although its line was switched off: do not open again then.
    bool may_be_on() const { return player_ != nullptr && player_->stats().left_on; }
    /// False when a signal has come.
    bool sleep(int fd, int timeout_ms, int also = -1);
    stroke_report end_of(stroke_id id);
    /// Ends the player's stream, and keeps what it gave the array.
    void end_stream();

    play_options options_;
    const environment& environment_;
    stream_source source_;
    interrupt stop_;
    rt::event_fd news_;               ///< a stroke has begun or ended
    std::atomic<bool> begun_ = false; ///< the latest stroke
    play_lines lines_;
    play_log log_;
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

/// Says how a run went that is finished. The exit status where a signal ended it. \throws error where an
/// amplifier may be on, before all else.
std::optional<int> tell_end(const play_session& session, const play_options& o, const environment& e,
                            const run_report& r);

} // namespace tactor::cli
