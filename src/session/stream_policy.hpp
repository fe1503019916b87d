// SPDX-License-Identifier: MIT
/// \file
/// Decides when a stream's device is opened and closed. Knows no device and no clock.
#pragma once

#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace tactor::session {

/// State of a stream, as clients and owners read it.
enum class stream_state { running, idle, lost, muted, closing };
std::string_view to_string(stream_state s) noexcept;

/// Times of a stream's policy, s.
struct stream_times {
    double wait_s = std::numeric_limits<double>::infinity(); ///< for a lost device; 0: no waiting
    double retry_s = 0.1;     ///< first pause before it is opened again; then twice as long, up to 5 s
    double proof_s = 1.0;     ///< a device that was lost is running when it has held for so long
    double idle_stop_s = 0.0; ///< the device is closed after so long without a stroke; 0: never
};

/// Its owner says what has happened, then asks step() what to do.
class stream_policy {
public:
    using time = std::chrono::steady_clock::time_point;
    enum class act { nothing, open, close };

    explicit stream_policy(const stream_times& t) : times_(t), pause_s_(t.retry_s) {}

    /// Returns what to do now: the same until it is begun.
    act step(time now);
    /// Returns when to call step() again though nothing happens; nothing: not before something does.
    std::optional<time> again() const noexcept { return again_; }

    /// The device is being opened or closed; opened(), failed() or closed() follows.
    void begin() noexcept
    {
        phase_ = phase::working;
        due_.reset();
    }
    void opened();
    void failed(std::string why);
    /// `left_on`: the amplifier may be on. Then the device is never opened again.
    void closed(bool left_on);
    /// The stream has ended by itself.
    void ended(std::string why);
    /// The stream ends because everything was stopped. The next stroke opens it again.
    void stopped();
    /// The amplifier is off, or not, while the stream goes on.
    void mute(bool is);
    /// Strokes go on or wait, or there are none.
    void set_busy(bool is);
    /// A stroke waits for a stream that is closed, or is being closed.
    void wake() noexcept { wanted_ = true; }
    /// Close for good.
    void end();

    stream_state state() const noexcept { return state_; }
    const std::string& reason() const noexcept { return reason_; }
    /// Returns true if a device that opens has yet to hold: it was lost.
    bool proves() const noexcept { return proves_; }
    /// Returns true if the device is lost, and not being opened at this moment.
    bool is_out() const noexcept { return phase_ == phase::shut && state_ == stream_state::lost; }
    /// Returns true if the device is closed for good.
    bool is_over() const noexcept { return phase_ == phase::shut && (given_up_ || closing_); }

private:
    enum class phase { shut, working, open };

    act step_shut(time now);
    act step_open(time now);
    bool is_due(time now, double after_s);
    void set(stream_state s, std::string reason);
    void run();

    stream_times times_;
    phase phase_ = phase::shut;
    stream_state state_ = stream_state::lost;
    std::string reason_ = "the device was not opened yet";
    double pause_s_;
    bool proves_ = false;
    bool wanted_ = true;  ///< at once
    bool broken_ = false; ///< the stream on the open device has ended
    bool busy_ = false;
    bool closing_ = false;  ///< for good
    bool given_up_ = false; ///< nothing is waited for any more
    std::optional<time> again_;
    std::optional<time> due_; ///< of the pause, the proof or the idle stop
    std::optional<time> give_up_at_;
};

} // namespace tactor::session
