// SPDX-License-Identifier: MIT
/// \file
/// Records of a stream: drive time of a device's channels, which counts on from player to player and from
/// process to process, and messages to the program's log about the stream. The audio thread itself writes
/// none.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>

#include "engine/link.hpp"
#include "synth/guard.hpp"

namespace tactor::engine {

/// Levels of drive time, s, at a CLOCK_BOOTTIME, which is up to a second ahead while somebody drives the
/// channels. A plain value.
struct drive_levels {
    std::vector<double> levels_s = {}; ///< by channel
    std::int64_t at_ns = 0;

    /// Returns the levels after a rest until `now_ns`, each at most `limit_s` before it. None if they are of
    /// a time to come, which is before this machine last started.
    std::vector<double> after_rest(std::int64_t now_ns, double limit_s, double leak) const;
    bool is_foreign(std::int64_t now_ns) const noexcept;

    /// Returns a text of a line each.
    std::string text() const;
    /// Returns the levels in such a text; none if it is not whole.
    static drive_levels read(std::string_view text);
};

/// Entries of a player so far. A plain value.
struct drive_share {
    std::vector<std::uint64_t> driven = {}; ///< frames by channel that were added
    double ahead_s = 0.0;                   ///< drive of all channels that was added beforehand
    std::int64_t entered_ns = 0;            ///< CLOCK_BOOTTIME
    std::int64_t left_ns = 0;               ///< drive_levels::at_ns after it

    /// Adds what was driven since the last call to `l`, and `next_s` for all channels beforehand, in place of
    /// what was added beforehand then. `all`: frames by channel until now. Where a channel was driven for a
    /// part of the time it counts as rested before; while others drive the device, too, nothing counts as
    /// rested.
    void enter(drive_levels& l, std::span<const std::uint64_t> all, double rate, double leak, double next_s,
               std::int64_t now_ns);
};

/// The book of a device: a file in the folder `tactor` of the user's runtime folder, and this process's
/// memory where there is no such folder. While something sounds, what may be driven until the next entry is
/// entered beforehand, so that a process that is killed counts, too, and at most that much too much. One
/// thread at a time.
class drive_book {
public:
    /// \param device empty: no book is kept
    drive_book(std::string device, const synth::guard_settings& g);

    bool has_device() const noexcept { return !device_.empty(); }
    /// Returns the levels of drive time now, s, by channel. Blocks shortly.
    std::vector<double> read() const;
    /// Enters what was driven, if it is time to. `driven`: frames by channel so far. `sounds`: a channel may
    /// be driven from now on. Blocks shortly.
    void enter(std::span<const std::atomic<std::uint64_t>> driven, bool sounds) noexcept;

private:
    std::string device_;
    std::string path_; ///< empty: there is no folder
    double limit_s_;
    double leak_;
    double rate_;
    drive_share share_;
};

/// Log of the control thread. look() collects under the player's mutex; write() calls the function without
/// it.
class stream_log {
public:
    stream_log(log_function to, const link& l, const drive_limits& limits)
        : to_(std::move(to)), link_(l), limits_(limits)
    {
    }

    /// Returns true if there is a function. Without one the other members do nothing.
    bool on() const noexcept { return static_cast<bool>(to_); }
    const log_function& function() const noexcept { return to_; }

    /// Collects changes since the last look, at a CLOCK_MONOTONIC time.
    void look(const stream_status& s, std::int64_t now_ns) noexcept;
    /// Notes points of a live stroke above its level.
    void look_at_end(const stroke_report& r) noexcept;
    /// Notes once that the stream is over, and why. Empty: it was stopped in order.
    void end(const std::string& why) noexcept;
    void write() noexcept;

private:
    void add(log_kind k, std::string text);
    void look_at_stream(const stream_status& s);
    void look_at_limits();

    log_function to_;
    const link& link_;
    drive_limits limits_;
    std::vector<std::pair<log_kind, std::string>> lines_;

    std::uint64_t xruns_ = 0;
    std::uint64_t epoch_ = 1;
    bool given_up_ = false;
    bool asleep_ = false;
    bool ready_ = false;
    std::uint32_t mutes_ = 0;
    std::uint64_t stalls_ = 0;
    std::uint64_t off_failures_ = 0;
    bool stuck_ = false;
    std::uint64_t cut_ = 0;
    std::uint64_t limited_ = 0;
    std::uint64_t power_limited_ = 0;
    std::int64_t limits_logged_ns_ = 0;
    bool over_ = false;
};

} // namespace tactor::engine
