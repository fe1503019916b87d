// SPDX-License-Identifier: MIT
/// \file
/// The stream to a device: players one after the other, as often as the device is lost and comes back, and
/// the GPIO lines that they share.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

#include "rt/event_fd.hpp"
#include "session/environment.hpp"

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

/// Decides when the device is opened and closed; knows no device and no clock. Its owner says what has
/// happened, then asks step() what to do.
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

/// Adds a further player's counters.
void add_stats(player_stats& sum, const player_stats& more);

/// `muted`: off, though the player that has the lines had switched it on.
enum class amplifier_state { none, off, on, muted };
/// "none", "off" or "on".
std::string_view to_string(amplifier_state s) noexcept;

/// Opens the lines that [amplifier] and [sync] name, unless no_gpio is set. Call it before threads and
/// locked memory: it forks the holder of the amplifier's line. `arm`: the trigger is wanted. \throws error as
/// open_amplifier() does.
player_lines open_lines(const stream_options& o, const environment& e, bool arm);

/// GPIO lines that outlive each player: one that plays on after its device was lost is a new one.
class lent_lines {
public:
    lent_lines() : lent_lines(player_lines{}) {}
    explicit lent_lines(player_lines own);
    /// Lends the lines to one player at a time. `proof_s`: as player_lines.
    player_lines lend(double proof_s = 0.0) const;

    /// Replaces the line of sync pulses by what `change` makes of it (null: there is none), before the lines
    /// are lent. `pulse_s`: as player_lines.
    template <class Change>
    void change_sync(const Change& change, double pulse_s)
    {
        state_->own.sync_out = change(std::move(state_->own.sync_out));
        state_->own.pulse_s = pulse_s;
    }
    /// Calls `f`, which must not throw, when the amplifier has gone on or off, in the thread that switches.
    void on_switch(std::function<void()> f) { state_->switched = std::move(f); }
    /// Returns what the line was switched to. Any thread.
    amplifier_state amplifier() const noexcept;

private:
    struct state {
        player_lines own;
        std::function<void()> switched = {};
        std::atomic<bool> on = false;
        std::atomic<bool> was_on = false; ///< with the player that has the lines
    };

    std::shared_ptr<state> state_;
};

struct stream_parts {
    std::function<std::unique_ptr<sink>()> open = {}; ///< blocks shortly. \throws error
    lent_lines lines = {};
    array tactors = {};
    player_options player = {};
    stream_times times = {};
    stream_setup wished = {}; ///< the setup before the device was ever there
    /// A stroke of the player with that number begins or has ended: as player::on_begin(), on_report().
    std::function<void(std::uint64_t, stroke_id, std::optional<std::int64_t> at_dac_ns)> begun = {};
    std::function<void(std::uint64_t, const stroke_report&)> ended = {};
};

/// Returns the parts of a stream on a PCM, with the lines of the configuration: call it before threads and
/// locked memory, as open_lines(). \throws error as that.
stream_parts open_parts(const alsa_options& device, const stream_options& o, const environment& e, bool arm);

/// Has no thread: what blocks is handed out as work. One thread calls all members.
class device_stream : private stream_policy {
public:
    explicit device_stream(stream_parts p);
    ~device_stream();
    device_stream(const device_stream&) = delete;
    device_stream& operator=(const device_stream&) = delete;

    using stream_policy::end, stream_policy::is_out, stream_policy::is_over, stream_policy::reason,
        stream_policy::set_busy, stream_policy::state, stream_policy::time, stream_policy::wake;

    /// Looks at what has happened. Call it when descriptor() is readable, after work, and at the time that it
    /// returns. Does not block.
    std::optional<time> step(time now = time::clock::now());
    /// Begins the work that step() found, and returns true if there is any: then call work().
    bool begin_work();
    /// Opens or closes the device, and blocks. Any thread.
    void work();
    /// Does both here. Blocks.
    bool work_here();
    /// Cancels all strokes. If the buffer is too long to wait for their fades, step() then closes the device;
    /// wake() opens it again.
    void cancel_all();
    /// Closes for good, here: fades out, stops, settles. No work may be under way. Blocks.
    void finish() noexcept;

    /// Readable when a stroke began or ended, the amplifier switched, or the player wrote to its log.
    int descriptor() const noexcept { return news_.fd(); }
    void take_news() noexcept { news_.consume(); }

    /// The player, or null.
    player* current() const noexcept { return player_.get(); }
    /// Number of the player, from 1; of the last one where there is none.
    std::uint64_t number() const noexcept { return number_; }
    /// Reason why the latest opening failed; null: it did not.
    const std::exception_ptr& failure() const noexcept { return failure_; }
    /// Latest setup of the device.
    const stream_setup& setup() const noexcept { return setup_; }
    /// Counters of all players.
    player_stats stats() const;
    amplifier_state amplifier() const noexcept { return parts_.lines.amplifier(); }

private:
    struct outcome;

    void open();
    void close();
    void settle();

    rt::event_fd news_;
    stream_parts parts_;
    act due_ = act::nothing;
    std::unique_ptr<outcome> outcome_; ///< of work under way
    std::unique_ptr<player> player_;
    std::uint64_t number_ = 0;
    std::exception_ptr failure_;
    stream_setup setup_;
    player_stats before_;             ///< of the players before this one
    bool drive_time_doubted_ = false; ///< said already
};

} // namespace tactor::session
