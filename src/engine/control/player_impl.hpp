// SPDX-License-Identifier: MIT
/// \file
/// State of a player that its threads and its callers share, and its control thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <tactor/phantom.hpp>
#include <tactor/player.hpp>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "engine/control/line_threads.hpp"
#include "engine/control/records.hpp"
#include "engine/link.hpp"
#include "rt/event_fd.hpp"
#include "rt/thread.hpp"

namespace tactor {
inline namespace v0 {

/// State of a player. The control thread shares its ownership while it works, so that a handler can destroy
/// the player.
struct player::impl : std::enable_shared_from_this<player::impl> {
    using report_handler = std::function<void(const stroke_report&)>;
    using begin_handler = std::function<void(stroke_id, std::optional<std::int64_t>)>;

    /// The control thread, which the audio thread wakes. It calls handle_wake_up() for each signal of
    /// link.to_control, and read_trigger_edges() while the trigger line is readable.
    class control_thread {
    public:
        /// Starts the thread.
        /// \throws std::system_error when the system refuses threads.
        explicit control_thread(impl& p);
        /// Ends the thread; it does not call the player afterwards. If the player's own handler destroys this
        /// object in the thread itself, the destructor returns at once, and the thread ends when the handler
        /// has returned. The event and the descriptor may be gone by then.
        ~control_thread();
        control_thread(const control_thread&) = delete;
        control_thread& operator=(const control_thread&) = delete;

        /// Watches the trigger line's descriptor, until read_trigger_edges() returns false. Call it once.
        void watch(int fd);
        bool is_current() const noexcept { return thread_.is_current(); }

    private:
        struct state;

        std::shared_ptr<state> state_; ///< shared with the thread, which may outlive this object for a moment
        rt::thread thread_;
    };

    impl(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines l);
    /// Starts the other threads. If it throws, no thread is left running.
    void start(const player_options& o);
    /// Ends all threads, and closes the sink and the lines. Call it once, after start().
    void close();

    std::size_t fire(std::int64_t time_ns);
    void stop(bool closing);

    // Under the mutex.

    /// Throws error (runtime) if the stream has ended or is about to.
    void check_open() const;
    /// Hands over drives. Returns false if memory ran out: nothing is lost, and the control thread tries
    /// again.
    bool pump();
    /// Asks the audio thread to fade out and end the stream.
    void end_stream(bool closing) noexcept;
    /// Returns the end of the stream, or the reason why it is about to end if a handler has failed.
    stream_end end() const;
    /// Finds an unread report; ended.end() if there is none.
    std::deque<stroke_report>::iterator find_report(stroke_id id);
    stroke_id next_id() noexcept { return {++last_id.number}; }

    std::unique_ptr<sink> out;
    /// Set-up at the stream's start. The audio thread may change the set-up in the sink later.
    stream_setup made;
    const std::string stream; ///< name of the stream in messages
    player_lines lines;
    engine::link link;
    std::mutex mutex; ///< guards the members below, except the threads; the audio thread never locks it
    std::condition_variable news;
    engine::feeder feed;
    std::deque<stroke_report> ended;     ///< unread reports, the oldest first
    std::list<stroke_report> unreported; ///< not yet passed to the handlers
    std::shared_ptr<const report_handler> handler;
    std::list<engine::feeder::stroke_start> begun; ///< not yet passed to the handler
    std::shared_ptr<const begin_handler> on_begun;
    std::multimap<stroke_id, report_handler> watchers;
    array tactors;
    std::vector<double> limits;  ///< limits of the array, by channel of the stream
    std::optional<layout> faces; ///< faces of the array, once a live stroke needs them
    stroke_id last_id = {};
    bool stopping = false;
    std::string handler_failed;               ///< text of an exception from a handler of the program, if any
    int empty_reads = 0;                      ///< empty reads of the trigger line, control thread
    const stroke_report* reporting = nullptr; ///< report that the handlers get now; control thread
    std::optional<std::int64_t> unfired;      ///< an edge for which there was no memory; control thread
    bool all_delivered = false;               ///< the stream is over, and the handlers have got all reports

    engine::stream_log log;  ///< used by the control thread once it runs
    engine::drive_book book; ///< used by the control thread once it runs

    const std::vector<double> drive_levels_s; ///< levels of the book when the stream began
    engine::audio_loop loop;
    engine::audio_thread audio;
    std::unique_ptr<control_thread> control;
    std::unique_ptr<engine::amplifier_thread> amplifier; ///< null without an amplifier
    std::unique_ptr<engine::trigger_thread> pulses;      ///< null without a line for pulses

private:
    void listen();
    void handle_wake_up();
    bool take_reports();
    bool read_trigger_edges();
    void call_handlers();
    void call_watchers(const stroke_report& r);
    template <typename Call>
    void call(Call&& callee) noexcept;
    void give_up(const char* what) noexcept;
};

} // namespace v0
} // namespace tactor
