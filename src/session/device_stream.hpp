// SPDX-License-Identifier: MIT
/// \file
/// The stream to a device. It continues when the device is lost and comes back, with one player after
/// another. The players share the GPIO lines.
#pragma once

#include <array>
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
#include "session/device.hpp"
#include "session/environment.hpp"

namespace tactor::session {

/// State of a stream, as clients and owners read it.
enum class stream_state { running, idle, lost, muted, closing };
inline constexpr std::array<std::string_view, 5> stream_state_names{"running", "idle", "lost", "muted",
                                                                    "closing"};
std::string_view to_string(stream_state s) noexcept;

/// Times of a stream's policy, s.
struct stream_times {
    double wait_s = std::numeric_limits<double>::infinity(); ///< maximum wait for the device; 0: no wait
    double retry_s = 0.1;     ///< first pause before the device is opened again; doubles each time, up to 5 s
    double proof_s = 1.0;     ///< time for which a lost device must run before it counts as back
    double idle_stop_s = 0.0; ///< time without a stroke after which the device is closed; 0: never
};

/// Policy that decides when the device is opened and closed, without knowing a device or a clock. Its owner
/// reports events, then asks step() for the next act.
class stream_policy {
public:
    using time = std::chrono::steady_clock::time_point;
    enum class act { nothing, open, close };

    explicit stream_policy(const stream_times& t) : times_(t), pause_s_(t.retry_s) {}

    /// Returns the next act. The result stays the same until begin().
    act step(time now);
    /// Returns the time at which to call step() again if no event comes before. Empty if only an event
    /// matters.
    std::optional<time> next_step_time() const noexcept { return again_; }

    /// Records that opening or closing the device begins. Call on_open(), on_failure() or on_close() next.
    void begin() noexcept
    {
        phase_ = phase::working;
        due_.reset();
    }
    void on_open();
    void on_failure(std::string why);
    /// Records that the device is closed. `left_on`: the amplifier may be on; then the device is never opened
    /// again.
    void on_close(bool left_on);
    /// Records that the stream has ended by itself, and why.
    void on_end(std::string why);
    /// Records that the owner stops the stream, and why. The next stroke opens the device again.
    void on_stop(std::string why);
    /// Records whether the amplifier is off while the stream continues.
    void mute(bool is);
    /// Records whether there are strokes.
    void set_busy(bool is);
    /// Records that a stroke waits for a stream that is closed, or is being closed.
    void wake() noexcept { wanted_ = true; }
    /// Closes the device for good.
    void end();

    stream_state state() const noexcept { return state_; }
    const std::string& reason() const noexcept { return reason_; }
    /// Returns true if the device was lost and must prove that it runs.
    bool needs_proof() const noexcept { return proves_; }
    /// Returns true if the device is lost, and not being opened at this moment.
    bool is_unavailable() const noexcept { return phase_ == phase::shut && state_ == stream_state::lost; }
    /// Returns true if the device is closed for good.
    bool is_over() const noexcept { return phase_ == phase::shut && (given_up_ || closing_); }

private:
    enum class phase { shut, working, open };

    act step_while_shut(time now);
    act step_while_open(time now);
    bool is_due(time now, double after_s);
    void set(stream_state s, std::string reason);
    void run();

    stream_times times_;
    phase phase_ = phase::shut;
    stream_state state_ = stream_state::lost;
    std::string reason_ = "the device was not opened yet";
    double pause_s_;
    bool proves_ = false;
    bool wanted_ = true;  ///< a stroke waits: open the device at once
    bool broken_ = false; ///< the stream on the open device has ended
    bool busy_ = false;
    bool closing_ = false;  ///< end() was called
    bool given_up_ = false; ///< the device will not be opened again
    std::optional<time> again_;
    std::optional<time> due_; ///< end of the pause, the proof or the idle stop
    std::optional<time> give_up_at_;
};

/// Adds the counters of another player to `sum`.
void add_stats(player_stats& sum, const player_stats& more);

/// State of the amplifier. `muted`: the player switched the amplifier on, but something else switched it off.
enum class amplifier_state { none, off, on, muted };
/// Returns "none", "off" or "on".
std::string_view to_string(amplifier_state s) noexcept;

/// Opens the lines that [amplifier] and [sync] name, unless no_gpio is set. Call it before threads start and
/// memory is locked, because it forks the holder of the amplifier's line. `arm`: also opens the trigger.
/// \throws error as open_amplifier() does.
player_lines open_lines(const stream_options& o, const environment& e, bool arm);

/// Returns an amplifier's line that must be off while the system sleeps. It delays sleep until the line is
/// off, for a second at most. Starts a thread.
std::unique_ptr<enable_line> keep_off_while_asleep(std::unique_ptr<enable_line> line);

/// GPIO lines that outlive each player. After a device was lost, a new player uses the same lines.
class lent_lines {
public:
    lent_lines() : lent_lines(player_lines{}) {}
    explicit lent_lines(player_lines own);
    /// Lends the lines to one player at a time. `proof_s`: value of player_lines::proof_s.
    player_lines lend(double proof_s = 0.0) const;

    /// Opens the amplifier's line anew by `open` if it was lost, such as when its holder was killed, or if an
    /// earlier call failed. Call it while the lines are not lent. \throws exceptions of `open`.
    void renew_amplifier(const std::function<std::unique_ptr<enable_line>()>& open);

    /// Replaces the line of sync pulses by the result of `change`(line), which may be null for no line. Call
    /// it before the lines are lent. `pulse_s`: value of player_lines::pulse_s.
    template <class Change>
    void change_sync(const Change& change, double pulse_s)
    {
        state_->own.sync_out = change(std::move(state_->own.sync_out));
        state_->own.pulse_s = pulse_s;
    }
    /// Sets a function that is called after the amplifier has gone on or off, in the thread that switches it.
    /// The function must not throw.
    void set_switch_handler(std::function<void()> f) { state_->switched = std::move(f); }
    /// Returns the state to which the line was switched. Any thread.
    amplifier_state amplifier() const noexcept;

private:
    struct state {
        player_lines own;
        std::function<void()> switched = {};
        std::atomic<bool> on = false;
        std::atomic<bool> was_on = false;  ///< the player that has the lines has switched the amplifier on
        std::atomic<bool> refused = false; ///< the amplifier's line did not go on: it may be lost
    };

    std::shared_ptr<state> state_;
};

struct stream_parts {
    std::function<std::unique_ptr<sink>()> open = {}; ///< opens the device; blocks briefly. \throws error
    std::shared_ptr<card_claim> card = std::make_shared<card_claim>();
    lent_lines lines = {};
    std::function<std::unique_ptr<enable_line>()> open_amplifier =
        {}; ///< opens a lost line anew; may be null
    array tactors = {};
    player_options player = {};
    stream_times times = {};
    stream_setup wished = {}; ///< assumed setup until the device opens for the first time
    /// Handlers like those of player::on_begin() and on_report(), with the player's number as first argument.
    std::function<void(std::uint64_t, stroke_id, std::optional<std::int64_t> at_dac_ns)> begun = {};
    std::function<void(std::uint64_t, const stroke_report&)> ended = {};
};

/// Returns the parts of a stream on a PCM, with the lines of the configuration. Call it before threads start
/// and memory is locked. Throws as open_lines() does.
stream_parts open_parts(const alsa_options& device, const stream_options& o, const environment& e, bool arm);

/// A stream without a thread: it hands out blocking calls as work. One thread calls all members but work().
class device_stream : private stream_policy {
public:
    explicit device_stream(stream_parts p);
    ~device_stream();
    device_stream(const device_stream&) = delete;
    device_stream& operator=(const device_stream&) = delete;

    using stream_policy::end, stream_policy::is_unavailable, stream_policy::is_over, stream_policy::reason,
        stream_policy::state, stream_policy::time, stream_policy::wake;

    /// Records whether there are strokes. While there are none, the device may be closed, and other programs
    /// get the card on request. A stream for which this is never called keeps its card.
    void set_busy(bool is);
    /// Handles events. Returns the time at which to call it again. Also call it when descriptor() is
    /// readable, and after work(). Does not block.
    std::optional<time> step(time now = time::clock::now());
    /// Begins the work that step() found. Returns false if there is none. If it returns true, call work().
    bool begin_work();
    /// Opens or closes the device. Blocks. Any thread.
    void work();
    /// Calls begin_work() and work(). Blocks.
    bool run_work();
    /// Cancels all strokes. If the buffer is too long to wait for their fades, step() then closes the device;
    /// wake() opens it again.
    void cancel_all();
    /// Closes the device for good: fades out, stops, waits for the reports. Blocks. Precondition: work() is
    /// not running.
    void finish() noexcept;

    /// Returns a descriptor that is readable when a stroke began or ended, the amplifier switched, or the
    /// player logged.
    int descriptor() const noexcept { return news_.fd(); }
    void take_news() noexcept { news_.consume(); }

    /// Returns the player, or null.
    player* current() const noexcept { return player_.get(); }
    /// Returns the number of the player, or of the last one if there is none now. The first is 1.
    std::uint64_t number() const noexcept { return number_; }
    /// Returns the failure of the latest attempt to open the device; null if it succeeded.
    const std::exception_ptr& failure() const noexcept { return failure_; }
    /// Returns the latest setup of the device.
    const stream_setup& setup() const noexcept { return setup_; }
    /// Returns the sums of all players' counters.
    player_stats stats() const;
    amplifier_state amplifier() const noexcept { return parts_.lines.amplifier(); }

private:
    struct outcome;

    void open();
    void close();
    void finish_work();

    rt::event_fd news_;
    stream_parts parts_;
    act due_ = act::nothing;
    std::unique_ptr<outcome> outcome_; ///< outcome of the work under way
    std::unique_ptr<player> player_;
    std::uint64_t number_ = 0;
    std::exception_ptr failure_;
    stream_setup setup_;
    player_stats before_;             ///< counters of the players before the current one
    bool drive_time_doubted_ = false; ///< a doubt about drive time has been reported
};

} // namespace tactor::session
