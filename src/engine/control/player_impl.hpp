// SPDX-License-Identifier: MIT
/// \file
/// The two threads of a player and what its callers share with them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactor/phantom.hpp>
#include <tactor/player.hpp>

#include "engine/audio/audio_loop.hpp"
#include "engine/audio/audio_thread.hpp"
#include "engine/control/amplifier_driver.hpp"
#include "engine/control/control_thread.hpp"
#include "engine/control/feeder.hpp"
#include "engine/control/stream_log.hpp"
#include "engine/control/trigger_thread.hpp"
#include "engine/link.hpp"
#include "synth/guard/drive_history.hpp"

namespace tactor::engine {

/// Returns the array if it fits the stream; otherwise some drives would reach no tactor.
/// \throws error: bad_input for a tactor on a channel that the stream does not have, not_available for one
///         that has no channel of the device to itself.
const array& fitting(const array& a, const stream_setup& s);

/// Checks that a score fits the player. `limits`: of its array, by channel of the stream; 0: no tactor.
/// \throws error (bad_input) for a score that has another rate or number of channels, drives a channel
///         without a tactor, drives a tactor beyond its limit, or has its marker on a tactor's channel.
void check_fits(const score& s, const stream_setup& stream, std::span<const double> limits);

} // namespace tactor::engine

namespace tactor {
inline namespace v0 {

/// The time that each channel was driven, as of one moment.
struct drive_history::impl {
    synth::drive_history channels;
    std::int64_t taken_ns = 0; ///< CLOCK_MONOTONIC

    /// Returns the history as of `now_ns`: the time since `taken_ns` counts as silence, but for drives that
    /// were still to come.
    synth::drive_history as_of(std::int64_t now_ns) const;
    /// Returns the history as of now, without the drives that are still to come.
    synth::drive_history until_now() const;
};

/// Shared with the control thread while that is at work, so that a handler can destroy the player.
struct player::impl : std::enable_shared_from_this<player::impl> {
    using report_handler = std::function<void(const stroke_report&)>;
    using begin_handler = std::function<void(stroke_id, std::optional<std::int64_t>)>;

    /// Starts the stream.
    impl(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines l);
    /// Starts the other threads; if it throws, none of them is left.
    void start(const player_options& o);
    /// Ends them all, and closes the sink and the lines. Once, after start().
    void close();

    stroke_id submit(const score& s, start_at start);
    std::size_t fire(std::int64_t time_ns);
    live_stroke begin(const live_options& o);
    bool on_end(stroke_id id, report_handler done);
    bool cancel(stroke_id id);
    wait_result wait(stroke_id id, std::optional<double> timeout_s);
    void stop(bool closing);
    std::shared_ptr<const drive_history::impl> history();
    /// How the stream has ended, or is about to. Under the mutex.
    stream_end end() const;
    void keep(const stroke_report& r);

    std::unique_ptr<sink> out;
    /// Set-up at the stream's start: the audio thread may change the sink's own.
    stream_setup made;
    const std::string stream; ///< as messages call it
    player_lines lines;
    engine::link link;
    std::mutex mutex; ///< guards all that follows but the threads; the audio thread never sees it
    std::condition_variable news;
    engine::feeder feed;
    /// A report that nobody has taken, and the how manieth end it is about.
    struct kept_report {
        stroke_report report;
        std::uint64_t nth = 0;
    };
    std::map<stroke_id, kept_report> ended;
    std::map<std::uint64_t, stroke_id> by_end; ///< of `ended`
    std::uint64_t ends = 0;
    std::list<stroke_report> untold; ///< that the handlers have not seen
    std::shared_ptr<const report_handler> handler;
    std::list<std::pair<stroke_id, std::optional<std::int64_t>>> begun; ///< that its handler has not seen
    std::shared_ptr<const begin_handler> on_begun;
    std::multimap<stroke_id, report_handler> watchers;
    array tactors;
    std::vector<double> limits;  ///< of the array, by channel of the stream
    std::optional<layout> faces; ///< of the array, once a live stroke needs it
    stroke_id last_id = {};
    stroke_id next_id() noexcept { return {++last_id.number}; }
    bool stopping = false;
    std::string handler_failed;             ///< what one of the program's handlers threw; empty: none
    int empty_reads = 0;                    ///< of the trigger line, control thread
    const stroke_report* telling = nullptr; ///< the handlers see it now, control thread
    std::optional<std::int64_t> unfired;    ///< an edge for which there was no memory, control thread
    bool all_delivered = false;             ///< the stream is over and the handler has seen all

    engine::stream_log log; ///< control thread, once that runs

    engine::audio_loop loop;
    engine::audio_thread audio;
    std::unique_ptr<engine::control_thread> control;
    std::unique_ptr<engine::amplifier_thread> amplifier; ///< only where there is one
    std::unique_ptr<engine::trigger_thread> pulses;      ///< only where there is a line for them

private:
    void start_lines(const player_options& o);
    void check_start(const player_options& o);
    void log_start(const player_options& o) const;
    void listen();
    void woken();
    bool take_reports();
    bool pump();
    void check_open() const;
    bool edges();
    void tell();
    void tell_beginnings();
    void tell(const stroke_report& r);
    void tell_watchers(const stroke_report& r);
    template <typename Call>
    void call(Call&& told) noexcept;
    void give_up(const char* what) noexcept;
};

} // namespace v0
} // namespace tactor
