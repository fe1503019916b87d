// SPDX-License-Identifier: MIT
/// \file
/// The stream to the device: players one after the other, as often as it is lost and comes back.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>

#include <tactor/array.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>
#include <tactor/sink.hpp>

#include "server/page/level_meter.hpp"

namespace tactor::server {

/// As clients are told.
enum class stream_state { running, idle, lost, muted, closing };
std::string_view name_of(stream_state s) noexcept;

struct stream_options {
    /// Opens the device; blocks shortly. \throws error, of which not_available means not yet.
    std::function<std::unique_ptr<sink>()> open = {};
    /// Lines for one player; may be empty.
    std::function<player_lines()> lines = {};
    array tactors = {};         ///< with the limits that hold for all clients together
    player_options player = {}; ///< but `driven` and `log`
    log_function log = {};
    std::function<void(stream_state, const std::string& reason)> changed = {}; ///< for the owner
    /// In place of all that follows: what was asked for can be opened on no day. Only of the first attempt;
    /// later the device may be another one, and is tried again.
    std::function<void(std::exception_ptr)> refused = {};
    /// What the array was given lately, by whomever: asked for before each opening. None: by this stream.
    std::function<drive_history()> driven = {};
    /// Twice a second while strokes go on, that so many channels may be driven.
    std::function<void(unsigned channels)> going = {};
    /// What the array was given lately, each time that the device is closed.
    std::function<void(const drive_history&)> settled = {};
    stream_setup wished = {}; ///< what hello tells before the device was ever there
    bool has_amplifier = false;
    double idle_stop_s = 0.0; ///< 0: never
    double retry_s = 0.1;     ///< first pause before the device is tried again; then twice as long
    double proof_s = 1.0;     ///< a device that was lost is running when it has held for so long
};

/// One thread, the context's, calls all members, and is where all handlers run.
class stream {
public:
    struct handlers {
        /// The first frame of a stroke of the player with that number, and when it is at the DAC.
        std::function<void(std::uint64_t player, stroke_id, std::optional<std::int64_t> at_dac_ns)> begun;
        std::function<void(std::uint64_t player, const stroke_report&)> ended;
        std::function<void(stream_state, const std::string& reason)> changed;
    };

    stream(boost::asio::io_context& io, stream_options o, handlers h);
    ~stream();
    stream(const stream&) = delete;
    stream& operator=(const stream&) = delete;

    /// Begins to open the device.
    void start();
    /// Calls `ready` once there is a player, or it is known that there is none: at once where that is so.
    void when_ready(std::function<void()> ready);
    /// The player, or null.
    player* current() const noexcept { return player_.get(); }
    /// Nothing can be played, and nothing is about to change that.
    bool is_out() const noexcept
    {
        return player_ == nullptr && !opening_ && !retiring_ && state_ == stream_state::lost;
    }
    std::uint64_t number() const noexcept { return number_; }

    stream_state state() const noexcept { return state_; }
    const std::string& reason() const noexcept { return reason_; }
    /// Of the device, as it was last.
    const stream_setup& setup() const noexcept { return setup_; }
    player_stats stats() const;
    /// "on", "off" or "none".
    std::string_view amplifier() const noexcept;
    level_peaks& peaks() noexcept { return *peaks_; }
    /// Whether the audio thread has gone on since the last call, or has no reason to.
    bool progresses();

    /// Strokes go on, or there are none: when to stop for want of them.
    void busy(bool is);

    /// Fades out and closes; `done` when all strokes were reported.
    void close(std::function<void()> done);

private:
    struct watch;

    void open();
    void opened(std::unique_ptr<player> p, std::string failure, const std::exception_ptr& bad);
    void prove();
    void run();
    void look();
    void retire(std::function<void()> then);
    void set(stream_state s, std::string reason);
    void retry();
    void tell_waiting();
    void give_up();
    void tell_going();

    boost::asio::io_context& io_;
    stream_options options_;
    handlers handlers_;
    std::shared_ptr<watch> watch_;
    std::shared_ptr<level_peaks> peaks_;
    std::unique_ptr<player> player_;
    std::uint64_t number_ = 0;
    stream_state state_ = stream_state::lost;
    std::string reason_ = "the device was not opened yet";
    stream_setup setup_;
    player_stats before_;
    drive_history driven_;
    std::vector<std::function<void()>> waiting_;
    std::function<void()> closed_;
    bool opening_ = false;
    bool tried_ = false;
    bool retiring_ = false;
    bool closing_ = false;
    bool busy_ = false;
    bool left_on_ = false; ///< the amplifier may be on: the device is not opened again
    double pause_s_ = 0.0;
    std::uint64_t seen_periods_ = 0;
    boost::asio::steady_timer again_;
    boost::asio::steady_timer proof_;
    boost::asio::steady_timer idle_;
    boost::asio::steady_timer going_;
    boost::asio::thread_pool worker_{1}; ///< opens and closes, which blocks
};

} // namespace tactor::server
