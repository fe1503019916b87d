// SPDX-License-Identifier: MIT
/// \file
/// Control side of playback: it hands the drives of scores to the audio thread in advance, up to a horizon.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactor/player.hpp>
#include <tactor/render.hpp>

#include "engine/link.hpp"
#include "engine/live.hpp"
#include "synth/score/event_source.hpp"

namespace tactor::engine {

class trigger_thread;

/// Feeder of the command ring: it merges the drives of the submitted scores by start frame. Scores wait here
/// while the ring or the table is full. Nothing is lost, and memory does not grow with the length of a score.
/// No threads: one caller at a time.
class feeder {
public:
    feeder(link& l, std::uint64_t horizon_frames);

    /// Submits a stroke. `gain`: factor of its amplitudes, as set_gain() sets it.
    void submit(stroke_id id, const score& s, start_at start, float gain = 1.0F);
    /// Submits a live stroke, which begins with its first point. Keeps `voice` until the stroke has ended.
    void submit(stroke_id id, std::shared_ptr<live_voice> voice);

    /// Starts the armed strokes at a CLOCK_MONOTONIC time, ns. Returns the number of strokes.
    std::size_t fire(std::int64_t time_ns);

    /// Cancels a stroke. Returns false if it has ended, is not known, or is being cancelled already.
    bool cancel(stroke_id id);
    /// Sets the factor of a stroke's amplitudes. Returns false if it has ended or is not known.
    bool set_gain(stroke_id id, float gain);
    /// Returns the stream frame at which a planned stroke began, if it sounds now.
    std::optional<std::uint64_t> find_first_frame(stroke_id id) const;
    /// Cancels all strokes up to `last`. The audio thread gets its requests at once. Strokes that wait end in
    /// the next pump(), because there may be thousands.
    void cancel_all(stroke_id last) noexcept;

    /// Sends a sync pulse for each stroke that begins from now on. `t` must outlive the strokes.
    void set_trigger_thread(trigger_thread& t) noexcept { pulses_ = &t; }

    /// Hands over the drives within the horizon after stream frame `written`, or as many as fit. Strokes with
    /// a start time wait until the clock is known.
    void pump(std::uint64_t written, const clock_line& clock = {});

    /// Returns true if the audio thread must be woken, because a stroke that begins was handed over since the
    /// last call. Drives of strokes that already sound can wait for the next period.
    bool take_wake_request() noexcept { return std::exchange(urgent_, false); }

    void handle(const report& r);

    /// Returns the reports of strokes that ended, in order of their ends. The caller removes them.
    std::list<stroke_report>& reports() noexcept { return reports_; }

    /// A stroke that began, and the CLOCK_MONOTONIC time, ns, of its first frame at the DAC, if the clock is
    /// known. The caller removes the elements from the list.
    using stroke_start = std::pair<stroke_id, std::optional<std::int64_t>>;
    std::list<stroke_start>& beginnings() noexcept { return beginnings_; }

    using live_map = std::map<stroke_id, std::shared_ptr<live_voice>>;
    /// Returns the live strokes that have ended. Take them out and destroy them without a lock: the last
    /// owner destroys the phantom model, which may be the program's own code.
    live_map& ended_live_strokes() noexcept { return ended_live_; }

    /// Returns true if the stroke has not ended, or its report has not been removed yet.
    bool knows(stroke_id id) const;
    /// Returns true if the stream has ended; then every stroke has been reported.
    bool stream_over() const noexcept { return stream_over_; }
    /// Returns how the stream ended. The reason is `none` if the stream was stopped.
    const stream_end& end() const noexcept { return end_; }
    /// Marks the player as closed: strokes that have not been handed over then end as interrupted by the
    /// closing.
    void set_closing() noexcept { closing_ = true; }

private:
    struct task {
        stroke_id id = {};
        tactor::score score;
        std::optional<std::int64_t> due_ns{}; ///< requested CLOCK_MONOTONIC
    };
    struct active {
        stroke_id id = {};
        std::optional<tactor::score> score{};
        live_voice* voice = nullptr; ///< owned by playing_live_
        std::optional<std::int64_t> due_ns{};
        std::uint64_t at = 0;
        std::uint64_t base = 0;         ///< stream frame of its start, once begun
        std::optional<double> late_s{}; ///< empty if the clock was not known when the stroke began
        std::optional<synth::event_source> source{};
        bool begun = false;
        bool fed = false;
        bool cancelled = false;
    };
    /// Next drive of a score that still gets drives.
    struct next_drive {
        std::uint64_t start = 0; ///< stream frame
        std::uint32_t order = 0; ///< position in in_use_
        bool operator>(const next_drive& o) const noexcept
        {
            return start != o.start ? start > o.start : order > o.order;
        }
    };
    struct slot {
        std::uint32_t generation = 1; ///< ticket 0 belongs to no score
        std::optional<active> use;
    };

    bool admit(std::uint64_t written);
    void update_waiting_live(std::uint64_t written);
    void admit_live();
    std::uint32_t take_slot(active a);
    ticket current_ticket(std::uint32_t place) const noexcept
    {
        return place + voices * slots_[place].generation;
    }
    bool cancel_waiting_stroke(stroke_id id);
    void end_live(live_map::iterator w);
    std::vector<std::uint32_t>::const_iterator find_playing_stroke(stroke_id id) const;
    void cancel_playing_stroke(std::uint32_t place) noexcept;
    void end_cancelled_strokes();
    template <typename End>
    void end_waiting_strokes(stroke_id last, End end);
    bool waits(stroke_id id) const;
    void handle_begin(active& a, std::uint64_t frame);
    void report_score_end(const active& a, const report& r);
    void report_end(stroke_report r);
    void feed(std::uint64_t written, std::uint64_t horizon);
    bool has_room(std::size_t n);
    void push_first_commands(active& a, ticket t, std::size_t drives);
    static command take_next_command(active& a, ticket t);
    static std::uint64_t next_start(active& a, std::uint64_t written);
    void release(slot& s) noexcept;
    void end_all(const report& r);

    link& link_;
    std::uint64_t horizon_;
    std::multimap<std::uint64_t, task> waiting_; ///< by stream frame
    std::multimap<std::int64_t, task> timed_;    ///< by CLOCK_MONOTONIC, ns
    std::map<stroke_id, task> armed_;
    live_map waiting_live_;
    live_map playing_live_;
    live_map ended_live_;
    std::optional<std::uint64_t> seen_written_ = {}; ///< stream frame at the last look at waiting_live_
    clock_line clock_;
    std::array<slot, voices> slots_;
    std::vector<std::uint32_t> in_use_; ///< places, in the order in which they began
    std::vector<next_drive> next_;      ///< a heap, the earliest first; of fixed capacity
    std::vector<command> batch_;        ///< buffer of fixed capacity
    std::map<stroke_id, float> gains_;  ///< only of strokes whose gain was set
    std::list<stroke_report> reports_;
    std::list<stroke_start> beginnings_;
    trigger_thread* pulses_ = nullptr;
    stroke_id cancelled_to_ = {}; ///< argument of cancel_all(), until the waiting strokes have ended
    bool urgent_ = false;
    bool stream_over_ = false;
    bool closing_ = false;
    stream_end end_;
};

/// Returns a reason as text for people; empty for `none`. `code`: negative errno, or 0 if unknown.
std::string text(reason_kind r, int code);

} // namespace tactor::engine
