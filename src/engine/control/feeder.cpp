// SPDX-License-Identifier: MIT
#include "engine/control/feeder.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <functional>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "engine/control/line_threads.hpp"
#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Total number of drives that strokes get at once when they begin together. The mixer has space for twice as
// many.
constexpr std::size_t drives_ahead = 4096;

template <typename Tasks>
auto find_task(Tasks& tasks, stroke_id id)
{
    return std::find_if(tasks.begin(), tasks.end(),
                        [id](const auto& entry) { return entry.second.id == id; });
}

template <typename Tasks>
bool erase_task(Tasks& tasks, stroke_id id)
{
    const auto found = find_task(tasks, id);
    if (found == tasks.end())
        return false;
    tasks.erase(found);
    return true;
}

// Possible error of the DAC clock's line between two readings.
constexpr double clock_right_s = 0.001;

// Returns the delay in seconds, 0 if it is within a frame. `due_ns` may be any number.
double compute_delay_s(std::int64_t started_ns, std::int64_t due_ns, double ns_per_frame)
{
    const double ns = static_cast<double>(started_ns) - static_cast<double>(due_ns);
    return ns > ns_per_frame ? ns * 1e-9 : 0.0;
}

// Returns the report of a stroke that was cut short before it began.
stroke_report make_interrupted_report(stroke_id id, reason_kind r, std::string why)
{
    return {.id = id, .state = state_kind::interrupted, .reason = r, .why = std::move(why)};
}

} // namespace

feeder::feeder(link& l, std::uint64_t horizon_frames) : link_(l), horizon_(horizon_frames)
{
    in_use_.reserve(voices);
    next_.reserve(voices);
    batch_.reserve(std::min(l.commands.capacity(), 2 + l.commands.capacity() / 8));
}

bool feeder::cancel(stroke_id id)
{
    if (cancel_waiting_stroke(id))
        return true;
    const auto playing = find_playing_stroke(id);
    if (playing == in_use_.end() || slots_[*playing].use->cancelled)
        return false;
    cancel_playing_stroke(*playing);
    return true;
}

std::vector<std::uint32_t>::const_iterator feeder::find_playing_stroke(stroke_id id) const
{
    return std::find_if(in_use_.begin(), in_use_.end(),
                        [&](std::uint32_t place) { return slots_[place].use->id == id; });
}

void feeder::cancel_playing_stroke(std::uint32_t place) noexcept
{
    active& a = *slots_[place].use;
    if (std::exchange(a.cancelled, true))
        return;
    a.fed = true;
    link_.requests.push({.what = request::kind::cancel, .score = current_ticket(place), .closing = false});
}

bool feeder::set_gain(stroke_id id, float gain)
{
    const auto playing = find_playing_stroke(id);
    if (playing == in_use_.end() && !waits(id))
        return false;
    gains_[id] = gain;
    if (playing != in_use_.end())
        link_.gains.set(current_ticket(*playing), gain);
    return true;
}

std::optional<std::uint64_t> feeder::find_first_frame(stroke_id id) const
{
    for (const std::uint32_t place : in_use_)
        if (const active& a = *slots_[place].use; a.id == id && a.begun && a.score)
            return a.base;
    return std::nullopt;
}

void feeder::cancel_all(stroke_id last) noexcept
{
    for (const std::uint32_t place : in_use_)
        cancel_playing_stroke(place);
    cancelled_to_ = last;
}

void feeder::end_cancelled_strokes()
{
    if (cancelled_to_ == stroke_id{})
        return;
    end_waiting_strokes(cancelled_to_,
                        [this](stroke_id id) { report_end({.id = id, .state = state_kind::cancelled}); });
    cancelled_to_ = {};
}

// Ends the strokes up to `last` that were not handed over, one after the other, so that the call can be
// repeated after memory ran out.
template <typename End>
void feeder::end_waiting_strokes(stroke_id last, End end)
{
    const auto end_tasks = [&](auto& tasks) {
        for (auto t = tasks.begin(); t != tasks.end();) {
            const stroke_id id = t->second.id;
            if (id <= last)
                end(id);
            t = id <= last ? tasks.erase(t) : std::next(t);
        }
    };
    end_tasks(armed_);
    end_tasks(waiting_);
    end_tasks(timed_);
    while (!waiting_live_.empty() && waiting_live_.begin()->first <= last) {
        const auto w = waiting_live_.begin();
        end(w->first);
        end_live(w);
    }
}

// Moves a waiting live stroke to the ended ones.
void feeder::end_live(live_map::iterator w)
{
    w->second->close();
    ended_live_.insert(waiting_live_.extract(w));
}

void feeder::pump(std::uint64_t written, const clock_line& clock)
{
    clock_ = clock;
    if (stream_over_)
        return;
    end_cancelled_strokes();
    // Converts times to frames as late as possible, when the clock is most accurate.
    while (!timed_.empty() && clock_.valid()) {
        const auto next = timed_.begin();
        const std::uint64_t at = clock_.frame_at(next->first);
        if (at > written + horizon_)
            break;
        waiting_.emplace(at, std::move(next->second));
        timed_.erase(next);
    }
    if (!waiting_live_.empty()) {
        update_waiting_live(written);
        admit_live();
    }
    // While a score waits for space, the others must not use up the space that becomes free.
    feed(written, admit(written) ? horizon_ : horizon_ / 2);
    // Armed strokes do not need the stream until they are triggered.
    link_.feeding.store(!waiting_.empty() || !timed_.empty() || !waiting_live_.empty() || !in_use_.empty(),
                        std::memory_order_relaxed);
}

// Begins the scores that are due within the horizon, the earliest first. Returns false if the ring had too
// little space.
bool feeder::admit(std::uint64_t written)
{
    const auto due = waiting_.upper_bound(written + horizon_);
    std::size_t beginning = 0;
    for (auto w = waiting_.begin(); w != due && in_use_.size() + beginning < voices; ++w)
        ++beginning;
    const std::size_t share = drives_ahead / std::max<std::size_t>(in_use_.size() + beginning, 1);
    while (!waiting_.empty() && waiting_.begin()->first <= written + horizon_ && in_use_.size() < voices) {
        if (!has_room(batch_.capacity()))
            return false;
        const auto& [at, t] = *waiting_.begin();
        const bool soon = at <= written + horizon_ / 8;
        const std::uint32_t place = take_slot({.id = t.id,
                                               .score = t.score,
                                               .due_ns = t.due_ns,
                                               .at = at,
                                               .source = synth::event_source(t.score)});
        try {
            // A score that begins later gets its drives from feed(), in order of their start.
            push_first_commands(*slots_[place].use, current_ticket(place),
                                soon ? std::max<std::size_t>(share, 1) : 0);
        } catch (...) {
            release(slots_[place]); // the score still waits
            throw;
        }
        waiting_.erase(waiting_.begin());
    }
    return true;
}

std::uint32_t feeder::take_slot(active a)
{
    const auto free = std::find_if(slots_.begin(), slots_.end(), [](const slot& s) { return !s.use; });
    free->use = std::move(a);
    const auto place = static_cast<std::uint32_t>(free - slots_.begin());
    in_use_.push_back(place);
    if (const auto gain = gains_.find(free->use->id); gain != gains_.end())
        link_.gains.set(current_ticket(place), gain->second);
    return place;
}

// Pushes the begin command and the first drives together: the audio thread starts the score as soon as it
// sees the begin command, and this thread may be preempted at any point.
void feeder::push_first_commands(active& a, ticket t, std::size_t drives)
{
    batch_.clear();
    batch_.push_back(
        {.what = command::kind::begin, .score = t, .id = a.id, .at = a.at, .length = a.score->frames()});
    const std::size_t most = std::min(batch_.capacity(), 1 + drives);
    while (batch_.size() < most && !a.fed) {
        const synth::drive_event* e = a.source->peek();
        if (e != nullptr && e->start > horizon_ / 8)
            break;
        batch_.push_back(take_next_command(a, t));
    }
    link_.commands.push(std::span<const command>(batch_));
    urgent_ = true;
}

// Takes the next drive from the source and returns its command, or the end command if there is none.
command feeder::take_next_command(active& a, ticket t)
{
    const synth::drive_event* e = a.source->peek();
    if (e == nullptr) {
        a.fed = true;
        return {.what = command::kind::end, .score = t};
    }
    command c{.what = command::kind::drive, .score = t, .drive = *e};
    c.drive.score = t;
    a.source->pop();
    return c;
}

std::uint64_t feeder::next_start(active& a, std::uint64_t written)
{
    const synth::drive_event* e = a.source->peek();
    // Until the audio thread reports the start of the score, only this lower bound is certain.
    const std::uint64_t base = a.begun ? a.base : std::max(a.at, written);
    return e != nullptr ? base + e->start : 0;
}

// Hands over drives in order of their start, until no drive within the horizon or no space is left.
void feeder::feed(std::uint64_t written, std::uint64_t horizon)
{
    next_.clear();
    for (std::uint32_t i = 0; i < in_use_.size(); ++i) {
        active& a = *slots_[in_use_[i]].use;
        if (!a.fed)
            next_.push_back({next_start(a, written), i});
    }
    std::make_heap(next_.begin(), next_.end(), std::greater<>{});
    while (!next_.empty() && next_.front().start <= written + horizon && has_room(1)) {
        std::pop_heap(next_.begin(), next_.end(), std::greater<>{});
        next_drive& n = next_.back();
        const std::uint32_t place = in_use_[n.order];
        active& a = *slots_[place].use;
        link_.commands.push(take_next_command(a, current_ticket(place)));
        if (a.fed) {
            next_.pop_back();
        } else {
            n.start = next_start(a, written);
            std::push_heap(next_.begin(), next_.end(), std::greater<>{});
        }
    }
}

bool feeder::has_room(std::size_t n)
{
    if (link_.commands.available() >= n)
        return true;
    // Either the audio thread makes space later and sees this flag, or the space is there already.
    link_.feeder_waits.store(true, std::memory_order_seq_cst);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    return link_.commands.available() >= n;
}

void feeder::release(slot& s) noexcept
{
    const auto place = static_cast<std::uint32_t>(&s - slots_.data());
    in_use_.erase(std::find(in_use_.begin(), in_use_.end(), place));
    if (s.use->voice != nullptr)
        ended_live_.insert(playing_live_.extract(s.use->id));
    s.use.reset();
    // Wraps after 16 million uses of one place; skips 0.
    s.generation = s.generation + 1 < UINT32_MAX / voices ? s.generation + 1 : 1;
}

void feeder::handle(const report& r)
{
    if (r.what == report::kind::stream_over)
        return end_all(r);
    slot& s = slots_[ticket_place(r.score)]; // still belongs to this ticket: only its last report releases it
    active& a = *s.use;
    if (r.what != report::kind::begun && pulses_ != nullptr)
        pulses_->forget(a.id, r.what == report::kind::over && r.frame > 0);
    switch (r.what) {
    case report::kind::begun:
        return handle_begin(a, r.frame);
    case report::kind::over:
        report_score_end(a, r);
        break;
    case report::kind::returned:
        if (a.cancelled)
            report_end({.id = a.id, .state = state_kind::cancelled, .frames = 0});
        else if (a.due_ns)
            timed_.emplace(*a.due_ns, task{a.id, *a.score, a.due_ns});
        else
            waiting_.emplace(a.at, task{a.id, *a.score});
        break;
    case report::kind::stream_over:
        return;
    }
    release(s);
}

void feeder::end_all(const report& r)
{
    end_ = {.reason = r.why, .why = text(r.why, r.code)};
    const reason_kind why = r.why == reason_kind::none && closing_ ? reason_kind::closed : r.why;
    const auto end = [&](stroke_id id, bool cancelled) {
        if (cancelled || why == reason_kind::none)
            report_end({.id = id, .state = state_kind::cancelled});
        else
            report_end(make_interrupted_report(id, why, text(why, r.code)));
    };
    while (!in_use_.empty()) {
        slot& s = slots_[in_use_.front()];
        end(s.use->id, s.use->cancelled);
        if (s.use->voice != nullptr)
            s.use->voice->close();
        release(s);
    }
    end_waiting_strokes({UINT32_MAX}, [&](stroke_id id) { end(id, id <= cancelled_to_); });
    stream_over_ = true;
}

bool feeder::knows(stroke_id id) const
{
    return waits(id) || find_playing_stroke(id) != in_use_.end() ||
           std::any_of(reports_.begin(), reports_.end(), [id](const auto& r) { return r.id == id; });
}

void feeder::submit(stroke_id id, const score& s, start_at start, float gain)
{
    std::map<stroke_id, float> own; // allocated here, before the stroke can play
    if (gain != 1.0F)
        own.emplace(id, gain);
    switch (start.what()) {
    case start_kind::frame:
        waiting_.emplace(start.stream_frame(), task{id, s});
        break;
    case start_kind::time:
        timed_.emplace(rt::to_ns(start.when()), task{id, s, rt::to_ns(start.when())});
        break;
    case start_kind::trigger:
        armed_.emplace(id, task{id, s});
        break;
    }
    gains_.merge(own);
}

void feeder::submit(stroke_id id, std::shared_ptr<live_voice> voice)
{
    if (waiting_live_.empty())
        seen_written_.reset(); // the last look was long ago
    waiting_live_.emplace(id, std::move(voice));
}

std::size_t feeder::fire(std::int64_t time_ns)
{
    end_cancelled_strokes();
    const std::size_t n = armed_.size();
    decltype(timed_) fired; // all or none, if memory runs out
    for (const auto& [id, t] : armed_)
        fired.emplace(time_ns, task{t.id, t.score, time_ns});
    timed_.merge(fired);
    armed_.clear();
    return n;
}

// Counts waiting time, as the audio thread does for the live strokes that it holds.
void feeder::update_waiting_live(std::uint64_t written)
{
    const std::uint64_t frames = written - std::exchange(seen_written_, written).value_or(written);
    for (auto next = waiting_live_.begin(); next != waiting_live_.end();) {
        live_voice& v = *next->second;
        v.wait(frames);
        const live_voice::action request = v.requested();
        if (request == live_voice::action::cancel)
            report_end({.id = next->first, .state = state_kind::cancelled});
        else if (request == live_voice::action::fail)
            report_end(make_interrupted_report(next->first, reason_kind::plan, v.failure()));
        else if (request == live_voice::action::end && !v.has_point())
            report_end({.id = next->first, .state = state_kind::finished});
        else if (v.starved())
            report_end(
                make_interrupted_report(next->first, reason_kind::starved, text(reason_kind::starved, 0)));
        else {
            ++next;
            continue;
        }
        end_live(next++);
    }
}

void feeder::admit_live()
{
    while (!waiting_live_.empty() && playing_live_.size() < live_places && in_use_.size() < voices) {
        const auto next = waiting_live_.begin();
        live_voice* const voice = next->second.get();
        const std::uint32_t place = take_slot({.id = next->first, .voice = voice, .fed = true});
        link_.requests.push(
            {.what = request::kind::live, .score = current_ticket(place), .id = next->first, .voice = voice});
        urgent_ = true;
        playing_live_.insert(waiting_live_.extract(next));
    }
}

bool feeder::cancel_waiting_stroke(stroke_id id)
{
    if (!waits(id))
        return false;
    // Reports first, because there may be no memory for the report.
    report_end({.id = id, .state = state_kind::cancelled, .frames = 0});
    const auto live = waiting_live_.find(id);
    if (live != waiting_live_.end()) {
        end_live(live);
        return true;
    }
    return erase_task(waiting_, id) || erase_task(timed_, id) || erase_task(armed_, id);
}

bool feeder::waits(stroke_id id) const
{
    return armed_.contains(id) || waiting_live_.contains(id) || find_task(waiting_, id) != waiting_.end() ||
           find_task(timed_, id) != timed_.end();
}

void feeder::handle_begin(active& a, std::uint64_t frame)
{
    a.begun = true;
    a.base = frame;
    const clock_line clock = link_.clock.load();
    // Allocates first, then plans pulses, and passes the beginning on last. If memory runs out, the report is
    // handled again, but neither the line nor a handler may get a beginning twice.
    const bool known = clock.valid() && frame >= clock.first;
    std::list<stroke_start> start;
    start.emplace_back(a.id, known ? std::optional(clock.time_at(frame)) : std::nullopt);
    if (pulses_ != nullptr && a.score)
        for (const std::uint64_t offset : a.score->starts())
            pulses_->add(a.id, frame + offset, clock);
    else if (pulses_ != nullptr)
        pulses_->add(a.id, frame, clock);
    if (a.due_ns && clock_.valid() && frame >= clock_.first)
        a.late_s = compute_delay_s(clock_.time_at(frame), *a.due_ns, clock_.ns_per_frame);
    else if (!a.due_ns && a.at != 0 && frame > a.at && a.score)
        a.late_s = static_cast<double>(frame - a.at) / a.score->rate();
    else if (!a.due_ns)
        a.late_s = 0.0;
    beginnings_.splice(beginnings_.end(), start);
}

void feeder::report_score_end(const active& a, const report& r)
{
    stroke_report done{.id = a.id,
                       .state = r.state,
                       .frames = r.frame,
                       .reason = r.why,
                       .why = r.why == reason_kind::plan ? a.voice->failure() : text(r.why, r.code),
                       .late_s = a.late_s.value_or(0.0),
                       .started_ns = {},
                       .first_frame = {},
                       .delay = {},
                       .held_points = 0,
                       .outside_points = 0,
                       .doubt = {}};
    if (r.started) {
        done.started_ns = r.started_ns;
        done.first_frame = a.base;
    }
    if (r.delay.points != 0)
        done.delay = r.delay;
    // The clock was not known when the stroke began, or the stream stood still before its first sample.
    if (r.started && a.due_ns)
        if (const double was = compute_delay_s(r.started_ns, *a.due_ns, 1e9 / a.score->rate());
            !a.late_s || was > *a.late_s + clock_right_s)
            done.late_s = was;
    report_end(std::move(done));
}

void feeder::report_end(stroke_report r)
{
    for (const live_map* live : {&playing_live_, &waiting_live_})
        if (const auto found = live->find(r.id); found != live->end()) {
            r.held_points = found->second->held_points();
            r.outside_points = found->second->outside_points();
            r.doubt = found->second->doubt();
        }
    gains_.erase(r.id);
    reports_.push_back(std::move(r));
}

std::string text(reason_kind r, int code)
{
    switch (r) {
    case reason_kind::none:
        return "";
    case reason_kind::xrun:
        return "xrun: the device ran dry";
    case reason_kind::suspended:
        return "the system was suspended";
    case reason_kind::lost:
        switch (-code) {
        case ETIMEDOUT:
            return "the device stopped";
        case EPIPE:
            return "the device was closed after too many xruns in a row";
        default:
            return "the device is gone";
        }
    case reason_kind::failed:
        return code == 0 ? "the device failed"
                         : fmt::format("the device failed: {}",
                                       std::error_code(-code, std::generic_category()).message());
    case reason_kind::late:
        return "the computer was too slow to prepare the stroke in time";
    case reason_kind::crowded:
        return "too many strokes at once (let fewer overlap; bursts need less than continuous strokes)";
    case reason_kind::starved:
        return "no more points came";
    case reason_kind::too_long:
        return "it reached the longest allowed duration";
    case reason_kind::muted:
        return "the amplifier was off";
    case reason_kind::amplifier:
        return "the amplifier's line cannot be switched";
    case reason_kind::left_on:
        return "the amplifier's line cannot be switched off: it may be on";
    case reason_kind::plan:
        return "the plan failed";
    case reason_kind::handler:
        return "a handler threw";
    case reason_kind::closed:
        return "the player was closed";
    }
    return "";
}

} // namespace tactor::engine
