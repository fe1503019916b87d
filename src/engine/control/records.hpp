// SPDX-License-Identifier: MIT
/// \file
/// Records of a stream: the drive time of a device's channels, which continues across players and processes,
/// and messages about the stream in the program's log. The audio thread itself writes no records.
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
#include "synth/limits/guard.hpp"

namespace tactor::engine {

/// Law of drive time: the maximum level, s, and how fast a level falls while a channel rests, s per second.
struct drive_law {
    double limit_s = 0.0;
    double leak = 1.0;
};

/// Levels of drive time of a device, s, at a CLOCK_BOOTTIME time. A plain value.
struct drive_levels {
    /// A run that drives the device, and the time by which it must make its next entry. A run that makes no
    /// entry by then was killed: it counts as if it had driven all channels for `ahead_s`.
    struct run {
        std::int64_t name = 0;
        std::int64_t until_ns = 0;
    };

    std::vector<double> levels_s = {}; ///< by channel of the device
    std::int64_t at_ns = 0;
    std::vector<run> runs = {};

    /// Advances to `now_ns`, and adds the possible drive of killed runs.
    void advance(std::int64_t now_ns, const drive_law& law);
    /// Advances to `now_ns`. Channel i was driven for drive_s[i] since `at_ns` (or since an earlier time, if
    /// others made entries meanwhile); other channels rested. Assumes that a channel rested first.
    void add(std::span<const double> drive_s, std::int64_t now_ns, const drive_law& law);

    /// Returns the levels and runs as text, a line each. `boot`: identifier of this boot.
    std::string text(std::string_view boot) const;
    /// Reads a text that text() made, and ignores anything after it. Returns nothing if the text is
    /// incomplete or from the future, and empty levels if it is from another boot.
    static std::optional<drive_levels> read(std::string_view text, std::string_view boot,
                                            std::int64_t now_ns);
};

/// Drive that a player has entered so far. A plain value.
struct drive_share {
    std::int64_t name = 0;                  ///< differs from the names of all other runs
    std::vector<std::uint64_t> driven = {}; ///< number of frames entered so far, by channel
    std::vector<double> last_levels_s = {}; ///< levels after the last entry, by channel of the device
    std::int64_t entered_ns = 0;            ///< time of the last entry, CLOCK_BOOTTIME
    bool sounds = false;                    ///< channels may have been driven since the last entry

    /// Adds the drive since the last call, s, by channel of the device, to `l`. `goes_on`: channels may be
    /// driven until the next call, at most 0.5 s later. Returns the level of each channel that other runs
    /// have driven since the last call, and 0 for the other channels.
    std::vector<double> enter(drive_levels& l, std::span<const double> drive_s, const drive_law& law,
                              bool goes_on, std::int64_t now_ns);
};

/// The book of a device's drive time: a file in the folder `tactor` of the user's runtime folder, or this
/// process's memory if there is no such folder. The book names each run that sounds, so that a killed run
/// counts, too. If a file exists but cannot be read completely, or is locked for 0.2 s, each channel counts
/// as being at the limit. One thread at a time, except for doubt().
class drive_book {
public:
    /// Opens the book and checks that it can be written. Blocks for 0.2 s at most.
    /// \param s stream; there is no book if `device` is empty
    /// \param clock CLOCK_BOOTTIME, ns
    drive_book(const stream_setup& s, const synth::guard_settings& g,
               std::function<std::int64_t()> clock = rt::boottime_ns);

    bool has_device() const noexcept { return !device_.empty(); }
    /// Returns the levels of drive time when the book was opened, s, by channel.
    std::vector<double> levels() const { return levels_at_channels(share_.last_levels_s); }
    /// Returns the reason why drive time is not kept across players, or counts as used up. Empty if there is
    /// no such reason. Any thread.
    std::string doubt() const;
    /// Enters the drive of this run if an entry is due, and reads the drive of other runs. `driven`: frames
    /// by channel so far. `sounds`: a channel may be driven from now on. `raised`: receives the levels, s, of
    /// channels that other runs have driven. Blocks briefly; for up to 0.2 s if nothing sounds. Returns true
    /// if there is a new doubt.
    bool enter(std::span<const std::atomic<std::uint64_t>> driven, bool sounds,
               level_requests& raised) noexcept;

private:
    bool record_doubt(std::string why);
    std::vector<double> levels_at_channels(const std::vector<double>& of_device) const;
    std::vector<double> drive_at_device(std::span<const std::uint64_t> now) const;
    bool enter(const std::vector<std::uint64_t>& now, bool sounds, level_requests& raised);

    std::string device_;
    std::string path_ = {}; ///< empty if there is no folder
    std::string boot_ = {};
    std::vector<std::vector<unsigned>> outputs_; ///< as stream_wiring::outputs
    std::size_t channels_;
    drive_law law_;
    double rate_;
    std::function<std::int64_t()> clock_;
    drive_share share_ = {};
    std::optional<std::int64_t> locked_ns_ = {}; ///< time since which another process has locked the file
    mutable std::mutex mutex_;                   ///< guards doubt_
    std::string doubt_ = {};
};

/// Log of the control thread. look() collects lines under the player's mutex; write() passes them to the
/// function without the mutex.
class stream_log {
public:
    stream_log(log_function to, const link& l, const drive_limits& limits)
        : to_(std::move(to)), link_(l), limits_(limits)
    {
    }

    /// Returns true if there is a function. Otherwise the other members do nothing.
    bool on() const noexcept { return static_cast<bool>(to_); }
    const log_function& function() const noexcept { return to_; }

    /// Collects changes since the last look, at a CLOCK_MONOTONIC time.
    void look(const stream_status& s, std::int64_t now_ns) noexcept;
    /// Adds warnings about the points of a live stroke that has ended.
    void log_stroke_end(const stroke_report& r) noexcept;
    /// Adds a warning about the stream.
    void warn(std::string_view stream, std::string_view what) noexcept;
    /// Adds the line about the end of the stream, once. `why`: empty if the stream was stopped as requested.
    void end(const std::string& why) noexcept;
    void write() noexcept;

private:
    void add(log_kind k, std::string text);
    void log_stream_changes(const stream_status& s);
    void log_limit_counts();

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
