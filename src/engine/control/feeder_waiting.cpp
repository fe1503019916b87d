// SPDX-License-Identifier: MIT
// Strokes that wait on the control side: for their frame, their time, a trigger or a free place.
#include <algorithm>
#include <utility>

#include "engine/control/feeder.hpp"

namespace tactor::engine {
namespace {

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

// Possible error of the DAC clock's line between two looks.
constexpr double clock_right_s = 0.001;

// Returns the delay in seconds, 0 within a frame. The requested time can be any number.
double late(std::int64_t started_ns, std::int64_t due_ns, double ns_per_frame)
{
    std::int64_t d = 0;
    const double ns = __builtin_sub_overflow(started_ns, due_ns, &d)
                          ? static_cast<double>(started_ns) - static_cast<double>(due_ns)
                          : static_cast<double>(d);
    return ns > ns_per_frame ? ns * 1e-9 : 0.0;
}

} // namespace

void feeder::submit(stroke_id id, const score& s, start_at start)
{
    switch (start.what()) {
    case start_kind::frame:
        waiting_.emplace(start.stream_frame(), task{id, s});
        return;
    case start_kind::time:
        timed_.emplace(start.time_ns(), task{id, s, start.time_ns()});
        return;
    case start_kind::trigger:
        armed_.emplace(id, task{id, s});
        return;
    }
}

void feeder::submit(stroke_id id, std::shared_ptr<live_voice> voice)
{
    if (waiting_live_.empty())
        seen_written_.reset(); // the last look was long ago
    waiting_live_.emplace(id, std::move(voice));
}

std::size_t feeder::fire(std::int64_t time_ns)
{
    end_cancelled();
    const std::size_t n = armed_.size();
    decltype(timed_) fired; // all or none, if memory runs out
    for (const auto& [id, t] : armed_)
        fired.emplace(time_ns, task{t.id, t.score, time_ns});
    timed_.merge(fired);
    armed_.clear();
    return n;
}

// Converts times to frames as late as possible, when the clock knows best.
void feeder::find_due(std::uint64_t written)
{
    while (!timed_.empty() && clock_.valid()) {
        const auto next = timed_.begin();
        const std::uint64_t at = clock_.frame_at(next->first);
        if (at > written + horizon_)
            return;
        waiting_.emplace(at, std::move(next->second));
        timed_.erase(next);
    }
}

// Counts waiting time, as the audio thread does for its live strokes.
void feeder::look_at_waiting_live(std::uint64_t written)
{
    const std::uint64_t frames = written - std::exchange(seen_written_, written).value_or(written);
    for (auto next = waiting_live_.begin(); next != waiting_live_.end();) {
        live_voice& v = *next->second;
        v.wait(frames);
        const live_voice::action asked = v.requested();
        if (asked == live_voice::action::cancel)
            report_end({.id = next->first, .state = state_kind::cancelled});
        else if (asked == live_voice::action::fail)
            report_end(interrupted(next->first, reason_kind::plan, v.failure()));
        else if (asked == live_voice::action::end && !v.has_point())
            report_end({.id = next->first, .state = state_kind::finished});
        else if (v.starved())
            report_end(interrupted(next->first, reason_kind::starved, text(reason_kind::starved, 0)));
        else {
            ++next;
            continue;
        }
        v.close();
        gone_live_.insert(waiting_live_.extract(next++));
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

bool feeder::cancel_waiting(stroke_id id)
{
    if (!waits(id))
        return false;
    // Reports first, because there may be no memory for it.
    report_end({.id = id, .state = state_kind::cancelled, .frames = 0});
    const auto live = waiting_live_.find(id);
    if (live != waiting_live_.end()) {
        live->second->close();
        gone_live_.insert(waiting_live_.extract(live));
        return true;
    }
    return erase_task(waiting_, id) || erase_task(timed_, id) || erase_task(armed_, id);
}

bool feeder::waits(stroke_id id) const
{
    return armed_.contains(id) || waiting_live_.contains(id) || find_task(waiting_, id) != waiting_.end() ||
           find_task(timed_, id) != timed_.end();
}

void feeder::begun(active& a, std::uint64_t frame)
{
    a.begun = true;
    a.base = frame;
    if (begins_ && a.score)
        for (const std::uint64_t start : a.score->starts())
            begins_(a.id, frame + start);
    else if (begins_)
        begins_(a.id, frame);
    if (a.due_ns && clock_.valid() && frame >= clock_.first)
        a.late_s = late(clock_.time_at(frame), *a.due_ns, clock_.ns_per_frame);
    else if (!a.due_ns && a.at != 0 && frame > a.at && a.score)
        a.late_s = static_cast<double>(frame - a.at) / a.score->rate();
    else if (!a.due_ns)
        a.late_s = 0.0;
    // Comes last: without memory the report is handled again, and no handler must hear it twice.
    if (keeps_beginnings_)
        beginnings_.push_back({a.id, frame});
}

void feeder::over(const active& a, const report& r)
{
    stroke_report done{.id = a.id,
                       .state = r.state,
                       .frames = r.frame,
                       .reason = r.why,
                       .why = r.why == reason_kind::plan ? a.voice->failure() : text(r.why, r.code),
                       .late_s = a.late_s.value_or(0.0),
                       .started_ns = {},
                       .delay = {},
                       .held_points = 0,
                       .outside_points = 0};
    if (r.started)
        done.started_ns = r.started_ns;
    if (r.delay.points != 0)
        done.delay = r.delay;
    // The clock was not known when it began, or the stream stood still between then and its first sample.
    if (r.started && a.due_ns)
        if (const double was = late(r.started_ns, *a.due_ns, 1e9 / a.score->rate());
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
        }
    gains_.erase(r.id);
    reports_.push_back(std::move(r));
}

} // namespace tactor::engine
