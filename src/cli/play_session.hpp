// SPDX-License-Identifier: MIT
/// \file
/// A run of `play`: players one after the other on one device, as often as that is lost and comes back.
#pragma once

#include <memory>
#include <string>

#include <tactor/tactor.hpp>

#include "cli/interrupt.hpp"
#include "cli/live_picture.hpp"
#include "cli/play_lines.hpp"
#include "cli/play_options.hpp"
#include "cli/play_report.hpp"

namespace tactor::cli {

/// Wakes the main thread when a stroke has ended.
class ended_signal {
public:
    ended_signal();
    ~ended_signal();
    ended_signal(const ended_signal&) = delete;
    ended_signal& operator=(const ended_signal&) = delete;

    void raise() const noexcept;
    void clear() const noexcept;
    int descriptor() const noexcept { return fd_; }

private:
    int fd_;
};

class play_session {
public:
    /// Opens lines and device, settles real time and starts the stream. \throws error.
    play_session(const alsa_options& device, const play_options& o, const environment& e);

    const stream_setup& setup() const noexcept { return setup_; }

    /// Plays one piece to its end, or until a signal comes, see signal(). \throws error.
    stroke_report play(const piece& p, const score& s);

    /// Whether the device is gone, or failed: nothing can be played until reopen().
    bool lost() const { return player_ == nullptr || player_->ended().has_value(); }
    /// Whether the stream ended of itself; after finish() this is settled.
    bool broke() const { return player_ != nullptr && !player_->ended().value_or("").empty(); }
    /// Whether a lost device is waited for.
    bool waits() const noexcept { return options_.reopen_s > 0.0; }
    /// Waits for the device, as long as --reopen-s says. False when it did not come back, or a signal came.
    bool reopen();

    /// Waits until a descriptor can be read. False when a signal has come.
    bool wait_for(int descriptor) { return sleep(descriptor, -1); }

    /// The signal that asked to end, or 0.
    int signal() const noexcept { return signal_; }

    /// Ends the stream in silence; its part of the report.
    void finish(run_report& r);

private:
    void start(std::unique_ptr<sink> s);
    void settle_realtime();
    /// False when a signal has come.
    bool sleep(int fd, int timeout_ms);

    play_options options_;
    const environment& environment_;
    interrupt stop_;
    ended_signal ended_;
    play_lines lines_;
    alsa_options device_;
    stream_setup setup_;
    std::unique_ptr<player> player_;
    player_stats before_;  ///< of the players before this one
    drive_history driven_; ///< what they gave the array lately
    unsigned reopened_ = 0;
    bool locked_ = false;
    int signal_ = 0;
};

} // namespace tactor::cli
