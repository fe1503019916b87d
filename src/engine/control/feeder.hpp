// SPDX-License-Identifier: MIT
/// \file
/// The control side's half of playing: hands scores over to the audio thread a horizon ahead.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
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
#include "engine/live/live_voice.hpp"
#include "engine/messages.hpp"
#include "synth/score/event_source.hpp"

namespace tactor::engine {

/// Merges the drives of the submitted scores by start frame and keeps the ring filled. A full ring or
/// table makes scores wait here; nothing is lost, and memory does not grow with the length of a score. No
/// threads of its own: one caller at a time.
class feeder {
public:
    feeder(link& l, std::uint64_t horizon_frames);

    void submit(stroke_id id, const score& s, start_at start);
    /// A live stroke, to begin with its first point. `voice` is kept until it has ended.
    void submit(stroke_id id, std::shared_ptr<live_voice> voice);

    /// Lets the armed ones start at a CLOCK_MONOTONIC time, ns; returns how many.
    std::size_t fire(std::int64_t time_ns);

    /// False when the stroke has ended, or is not known, or is being cancelled already.
    bool cancel(stroke_id id);

    /// `begins` is called for each stroke that begins, with its first frame of the stream. `ended` is called
    /// for each stroke that goes no further, with whether any of it was played: it ended, or an xrun came
    /// before it had begun.
    void on_first_frames(std::function<void(stroke_id, std::uint64_t)> begins,
                         std::function<void(stroke_id, bool)> ended)
    {
        begins_ = std::move(begins);
        ended_ = std::move(ended);
    }

    /// Hands over the drives within the horizon after stream frame `written`, as far as they fit. Strokes
    /// that are to start at a time wait until the clock is known.
    void pump(std::uint64_t written, const clock_line& clock = {});

    /// Whether the audio thread must be woken: since the last call, a stroke that begins was handed over.
    /// Drives of strokes that sound are still in time with the next period.
    bool take_urgent() noexcept { return std::exchange(urgent_, false); }

    /// Takes in what the audio thread reports.
    void handle(const report& r);

    /// Reports of strokes that ended, in order of their ends; the caller takes them from the list.
    std::list<stroke_report>& reports() noexcept { return reports_; }

    /// A stroke that began: its first frame was written, as that frame of the stream.
    struct first_frame {
        stroke_id id = {};
        std::uint64_t frame = 0;
    };
    /// From now on beginnings are kept; the caller takes them from the list.
    void keep_beginnings() noexcept { keeps_beginnings_ = true; }
    std::list<first_frame>& beginnings() noexcept { return beginnings_; }

    using live_map = std::map<stroke_id, std::shared_ptr<live_voice>>;
    /// Live strokes that have ended. They are to be taken out and destroyed where no lock is held: the last
    /// share of one destroys its phantom model, which may be the program's own.
    live_map& gone_live() noexcept { return gone_live_; }

    /// Whether there are reports.
    bool has_reports() const noexcept { return !reports_.empty(); }
    /// Whether the stroke has not ended, or its report has not been taken yet.
    bool knows(stroke_id id) const;
    /// Whether the stream has ended; every stroke has been reported then.
    bool stream_over() const noexcept { return stream_over_; }
    /// How it ended; no reason when it was stopped.
    const stream_end& end() const noexcept { return end_; }
    /// From now on, strokes that have not been handed over count as cut because the player was closed.
    void set_closing() noexcept { closing_ = true; }

private:
    struct task {
        stroke_id id = {};
        score music;
        std::optional<std::int64_t> due_ns{}; ///< CLOCK_MONOTONIC that was asked for
    };
    struct active {
        stroke_id id = {};
        std::optional<score> music{};
        live_voice* voice = nullptr; ///< playing_live_ has it
        std::optional<std::int64_t> due_ns{};
        std::uint64_t at = 0;
        std::uint64_t base = 0;         ///< stream frame of its start, once begun
        std::optional<double> late_s{}; ///< none: the clock was not known when it began
        std::optional<synth::event_source> source{};
        std::string failure{}; ///< why its plan could not be followed to its end
        bool begun = false;
        bool fed = false;
        bool cancelled = false;
    };
    /// The next drive of a score that is being fed.
    struct next_drive {
        std::uint64_t start = 0; ///< stream frame
        std::uint32_t order = 0; ///< in in_use_
        bool operator>(const next_drive& o) const noexcept
        {
            return start != o.start ? start > o.start : order > o.order;
        }
    };
    struct slot {
        std::uint32_t generation = 1; ///< ticket 0 belongs to no score
        std::optional<active> use;
    };

    void find_due(std::uint64_t written);
    bool admit(std::uint64_t written);
    bool has_strokes() const noexcept;
    void look_at_waiting_live(std::uint64_t written);
    void admit_live();
    std::uint32_t take_slot(active a);
    ticket ticket_of(std::uint32_t place) const noexcept { return place + voices * slots_[place].generation; }
    bool cancel_waiting(stroke_id id);
    bool waits(stroke_id id) const;
    void begun(active& a, std::uint64_t frame);
    void over(const active& a, const report& r);
    void tell(stroke_report r);
    void feed(std::uint64_t written, std::uint64_t horizon);
    bool has_room(std::size_t n);
    void hand_over_beginning(active& a, ticket t, std::size_t drives);
    static command next_command(active& a, ticket t);
    static std::uint64_t next_start(active& a, std::uint64_t written) noexcept;
    void release(slot& s) noexcept;
    void end_all(const report& r);

    link& link_;
    std::uint64_t horizon_;
    std::multimap<std::uint64_t, task> waiting_; ///< by frame of the stream
    std::multimap<std::int64_t, task> timed_;    ///< by CLOCK_MONOTONIC, ns
    std::map<stroke_id, task> armed_;
    live_map waiting_live_;
    live_map playing_live_;
    live_map gone_live_;
    std::optional<std::uint64_t> seen_written_ = {}; ///< at the last look at waiting_live_
    clock_line clock_;
    std::array<slot, voices> slots_;
    std::vector<std::uint32_t> in_use_; ///< places, in order of their beginning
    std::vector<next_drive> next_;      ///< a heap, the earliest first; of fixed capacity
    std::vector<command> batch_;        ///< of fixed capacity
    std::list<stroke_report> reports_;
    std::list<first_frame> beginnings_;
    bool keeps_beginnings_ = false;
    std::function<void(stroke_id, std::uint64_t)> begins_;
    std::function<void(stroke_id, bool)> ended_;
    bool urgent_ = false;
    bool stream_over_ = false;
    bool closing_ = false;
    stream_end end_;
};

/// A reason for people, with the negative errno that is known of it; empty for `none`.
std::string text(reason_kind r, int code);
/// The report of a stroke that was cut short before it began.
stroke_report interrupted(stroke_id id, reason_kind r, std::string why);

} // namespace tactor::engine
