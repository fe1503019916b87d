// SPDX-License-Identifier: MIT
/// \file
/// Records of a stream: drive time of a device's channels, which counts on from player to player and from
/// process to process, and messages to the program's log about the stream. The audio thread itself writes
/// none.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/sink.hpp>

#include "engine/link.hpp"
#include "rt/clock.hpp"
#include "synth/guard.hpp"

namespace tactor::engine {

/// Law of drive time: the greatest level, s, and how fast a level falls while a channel rests, s a second.
struct drive_law {
    double limit_s = 0.0;
    double leak = 1.0;
};

/// Levels of drive time of a device, s, at a CLOCK_BOOTTIME. A plain value.
struct drive_levels {
    /// A run that drives the device, and the time until which it may drive without another entry. If that
    /// passes without one, the run was killed, and counts as if it had driven all channels for `ahead_s`.
    struct run {
        std::int64_t name = 0;
        std::int64_t until_ns = 0;
    };

    std::vector<double> levels_s = {}; ///< by channel of the device
    std::int64_t at_ns = 0;
    std::vector<run> runs = {};

    /// Lets time pass until `now_ns`, and adds what runs that were killed may have driven.
    void pass(std::int64_t now_ns, const drive_law& law);
    /// Lets time pass until `now_ns`. Channel i was driven for drive_s[i] since `at_ns`, or, if others made
    /// entries meanwhile, since before; others rested. Counts as if a channel had rested first.
    void add(std::span<const double> drive_s, std::int64_t now_ns, const drive_law& law);

    /// Returns a text of a line each. `boot`: name of this start of the machine.
    std::string text(std::string_view boot) const;
    /// Returns the levels in such a text, and ignores what follows it: none if it is not whole or of a time
    /// to come, empty ones if it is from another start of the machine.
    static std::optional<drive_levels> read(std::string_view text, std::string_view boot,
                                            std::int64_t now_ns);
};

/// Entries of a player so far. A plain value.
struct drive_share {
    std::int64_t name = 0;                  ///< other than that of any other run
    std::vector<std::uint64_t> driven = {}; ///< frames by channel that were added
    std::vector<double> left_s = {};        ///< levels by channel of the device after the last entry, ...
    std::int64_t left_ns = 0;               ///< ... and when that was, CLOCK_BOOTTIME
    bool sounds = false;                    ///< since then

    /// Adds to `l` what was driven since the last call, s by channel of the device. `goes_on`: until the next
    /// call, 0.5 s later at most, more may be driven. Returns the levels of all channels, 0 where nobody else
    /// has driven them meanwhile.
    std::vector<double> enter(drive_levels& l, std::span<const double> drive_s, const drive_law& law,
                              bool goes_on, std::int64_t now_ns);
};

/// The book of a device: a file in the folder `tactor` of the user's runtime folder, and this process's
/// memory where there is no such folder. A run that sounds is in it by name, so that a run that is killed
/// counts, too. A file that is there and cannot be read as a whole, or is locked for 0.2 s, counts as if each
/// channel were at the limit. One thread at a time, but doubt().
class drive_book {
public:
    /// Opens the book, and finds out whether it can be written. Blocks for 0.2 s at most.
    /// \param s its `device`: empty: no book is kept
    /// \param clock CLOCK_BOOTTIME, ns
    drive_book(const stream_setup& s, const synth::guard_settings& g,
               std::function<std::int64_t()> clock = rt::boottime_ns);

    bool has_device() const noexcept { return !device_.empty(); }
    /// Returns the levels of drive time when the book was opened, s, by channel.
    std::vector<double> levels() const { return levels_at_channels(share_.left_s); }
    /// Returns why drive time is not counted on, or is taken for used; empty: it is counted. Any thread.
    std::string doubt() const;
    /// Enters what was driven, if it is time to, and looks at what others drove. `driven`: frames by channel
    /// so far. `sounds`: a channel may be driven from now on. `raised`: gets the levels, s, to which others
    /// have driven channels. Blocks shortly, for 0.2 s at most where nothing sounds. Returns true if there is
    /// a new doubt.
    bool enter(std::span<const std::atomic<std::uint64_t>> driven, bool sounds,
               level_requests& raised) noexcept;

private:
    bool doubts(std::string why);
    std::vector<double> levels_at_channels(const std::vector<double>& of_device) const;
    std::vector<double> drive_at_device(std::span<const std::uint64_t> now) const;
    bool enter(const std::vector<std::uint64_t>& now, bool sounds, level_requests& raised);

    std::string device_;
    std::string path_ = {}; ///< empty: there is no folder
    std::string boot_ = {};
    std::vector<std::vector<unsigned>> outputs_; ///< as stream_wiring::outputs
    std::size_t channels_;
    drive_law law_;
    double rate_;
    std::function<std::int64_t()> clock_;
    drive_share share_ = {};
    std::optional<std::int64_t> locked_ns_ = {}; ///< since when another process has kept it locked
    mutable std::mutex mutex_;                   ///< guards doubt_
    std::string doubt_ = {};
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
    /// Notes a warning about the stream.
    void warn(std::string_view stream, std::string_view what) noexcept;
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
