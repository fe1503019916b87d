// SPDX-License-Identifier: MIT
/// \file
/// The two threads of a player and what its callers share with them.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include <tactor/phantom.hpp>
#include <tactor/player.hpp>

#include "engine/amplifier_thread.hpp"
#include "engine/audio_loop.hpp"
#include "engine/audio_thread.hpp"
#include "engine/control_thread.hpp"
#include "engine/feeder.hpp"
#include "engine/link.hpp"
#include "engine/trigger_thread.hpp"

namespace tactor {

struct player::impl {
    impl(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines l);
    ~impl();

    stroke_id submit(const score& s, start_at start);
    std::size_t fire(std::int64_t time_ns);
    live_stroke begin(const live_options& o);
    bool on_end(stroke_id id, std::function<void(const stroke_report&)> done);
    bool cancel(stroke_id id);
    std::optional<stroke_report> wait(stroke_id id, std::optional<std::chrono::nanoseconds> timeout);
    void stop(bool closing);

    std::unique_ptr<sink> out;
    player_lines lines;
    engine::link link;
    std::mutex mutex; ///< guards all that follows but the threads; the audio thread never sees it
    std::condition_variable news;
    engine::feeder feed;
    std::map<stroke_id, stroke_report> ended;
    std::function<void(const stroke_report&)> handler;
    std::multimap<stroke_id, std::function<void(const stroke_report&)>> watchers;
    array tactors;
    std::optional<layout> faces; ///< of the array, once a live stroke needs it
    stroke_id last_id = 0;
    bool stopping = false;
    int empty_reads = 0;        ///< of the trigger line, control thread
    bool all_delivered = false; ///< the stream is over and the handler has seen all

    engine::audio_loop loop;
    engine::audio_thread audio;
    std::unique_ptr<engine::control_thread> control;
    std::unique_ptr<engine::amplifier_thread> amplifier; ///< only where there is one
    std::unique_ptr<engine::trigger_thread> pulses;      ///< only where there is a line for them

private:
    void start_lines(const player_options& o);
    void check_start(const player_options& o);
    void woken();
    void pump();
    void check_open() const;
    bool edges();
    void tell(const std::vector<stroke_report>& reports);
};

} // namespace tactor
