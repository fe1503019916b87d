// SPDX-License-Identifier: MIT
#include "engine/feeder.hpp"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>

namespace tactor::engine {

feeder::feeder(link& l, std::uint64_t horizon_frames) : link_(l), horizon_(horizon_frames)
{
    batch_.reserve(std::min(l.commands.capacity(), 2 + l.commands.capacity() / 8));
}

bool feeder::cancel(stroke_id id)
{
    if (cancel_waiting(id))
        return true;
    for (const std::uint32_t place : in_use_) {
        slot& s = slots_[place];
        if (s.use->id != id || s.use->cancelled)
            continue;
        s.use->cancelled = true;
        s.use->fed = true;
        link_.requests.push({.what = request::kind::cancel, .score = ticket_of(place), .closing = false});
        return true;
    }
    return false;
}

void feeder::pump(std::uint64_t written, const clock_line& clock)
{
    clock_ = clock;
    if (stream_over_)
        return;
    find_due(written);
    look_at_waiting_live(written);
    admit_live();
    // While a score waits for room, the others may not use up what becomes free.
    const std::uint64_t horizon = admit(written) ? horizon_ : horizon_ / 2;
    while (feed_next(written, horizon)) {
    }
}

// Begins what is due within the horizon, the earliest first; false when the ring had too little room.
bool feeder::admit(std::uint64_t written)
{
    while (!waiting_.empty() && waiting_.begin()->first <= written + horizon_ && in_use_.size() < voices) {
        if (!has_room(batch_.capacity()))
            return false;
        const auto& [at, t] = *waiting_.begin();
        const std::uint32_t place = take_slot({.id = t.id,
                                               .music = t.music,
                                               .due_ns = t.due_ns,
                                               .at = at,
                                               .source = synth::event_source(t.music)});
        hand_over_beginning(*slots_[place].use, ticket_of(place));
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
    return place;
}

// The begin and its first drives become visible together: the audio thread starts the score as soon as it
// sees the begin, and this thread may lose its processor at any point.
void feeder::hand_over_beginning(active& a, ticket t)
{
    batch_.clear();
    batch_.push_back(
        {.what = command::kind::begin, .score = t, .id = a.id, .at = a.at, .length = a.music->frames()});
    while (batch_.size() < batch_.capacity() && !a.fed) {
        const synth::drive_event* e = a.source->peek();
        if (e != nullptr && e->start > horizon_ / 8)
            break;
        batch_.push_back(next_command(a, t));
    }
    link_.commands.push(std::span<const command>(batch_));
}

// Takes the next drive from the source, or its end.
command feeder::next_command(active& a, ticket t)
{
    const synth::drive_event* e = a.source->peek();
    if (e == nullptr) {
        a.fed = true;
        if (!a.source->failure().empty()) {
            a.failure = a.source->failure();
            return {.what = command::kind::fail, .score = t, .at = a.source->failed_at()};
        }
        return {.what = command::kind::end, .score = t};
    }
    command c{.what = command::kind::drive, .score = t, .drive = *e};
    c.drive.score = t;
    a.source->pop();
    return c;
}

// Hands over the drive that starts first; false when there is none within the horizon, or no room.
bool feeder::feed_next(std::uint64_t written, std::uint64_t horizon)
{
    slot* first = nullptr;
    std::uint32_t first_place = 0;
    std::uint64_t first_start = 0;
    for (const std::uint32_t place : in_use_) {
        active& a = *slots_[place].use;
        if (a.fed)
            continue;
        const synth::drive_event* e = a.source->peek();
        // Until the audio thread says where it begins, what is certain is: not before this.
        const std::uint64_t base = a.begun ? a.base : std::max(a.at, written);
        const std::uint64_t start = e != nullptr ? base + e->start : 0;
        if (first == nullptr || start < first_start) {
            first = &slots_[place];
            first_place = place;
            first_start = start;
        }
    }
    if (first == nullptr || first_start > written + horizon)
        return false;

    if (!has_room(1))
        return false;
    link_.commands.push(next_command(*first->use, ticket_of(first_place)));
    return true;
}

bool feeder::has_room(std::size_t n)
{
    if (link_.commands.room() >= n)
        return true;
    // The audio thread either sees this flag after it made room, or the room is there already.
    link_.feeder_waits.store(true, std::memory_order_seq_cst);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    return link_.commands.room() >= n;
}

feeder::slot* feeder::slot_of(ticket t) noexcept
{
    slot& s = slots_[place_of(t)];
    return s.use && s.generation == t / voices ? &s : nullptr;
}

void feeder::release(slot& s) noexcept
{
    const auto place = static_cast<std::uint32_t>(&s - slots_.data());
    in_use_.erase(std::find(in_use_.begin(), in_use_.end(), place));
    if (s.use->voice)
        --live_in_use_;
    s.use.reset();
    // Wraps after 16 million uses of one place; 0 stays out.
    s.generation = s.generation + 1 < UINT32_MAX / voices ? s.generation + 1 : 1;
}

void feeder::handle(const report& r)
{
    if (r.what == report::kind::stream_over)
        return end_all(r);
    slot* s = slot_of(r.score);
    if (s == nullptr)
        return;
    active& a = *s->use;
    if (r.what != report::kind::begun && ended_)
        ended_(a.id);
    switch (r.what) {
    case report::kind::begun:
        return begun(a, r.frame);
    case report::kind::over:
        over(a, r);
        break;
    case report::kind::returned:
        if (a.cancelled)
            tell({.id = a.id, .state = stroke_state::cancelled, .frames = 0, .reason = {}});
        else if (a.due_ns)
            timed_.emplace(*a.due_ns, task{a.id, *a.music, a.due_ns});
        else
            waiting_.emplace(a.at, task{a.id, *a.music});
        break;
    case report::kind::stream_over:
        return;
    }
    release(*s);
}

void feeder::end_all(const report& r)
{
    stream_over_ = true;
    stream_reason_ = text(r.why, r.code);
    const bool cut = r.why != reason::none || closing_;
    const std::string why = r.why != reason::none ? stream_reason_ : cut ? text(reason::closed, 0) : "";
    const auto end = [&](stroke_id id, bool cancelled) {
        const auto state = cut && !cancelled ? stroke_state::interrupted : stroke_state::cancelled;
        tell({.id = id, .state = state, .frames = 0, .reason = cancelled ? std::string() : why});
    };
    while (!in_use_.empty()) {
        slot& s = slots_[in_use_.front()];
        end(s.use->id, s.use->cancelled);
        if (s.use->voice)
            s.use->voice->close();
        release(s);
    }
    for (const auto& [id, t] : armed_)
        end(id, false);
    for (const auto& [at, t] : waiting_)
        end(t.id, false);
    for (const auto& [time, t] : timed_)
        end(t.id, false);
    for (const auto& [id, voice] : waiting_live_) {
        voice->close();
        end(id, false);
    }
    armed_.clear();
    waiting_.clear();
    timed_.clear();
    waiting_live_.clear();
}

std::vector<stroke_report> feeder::take_reports()
{
    return std::exchange(reports_, {});
}

bool feeder::knows(stroke_id id) const
{
    return waits(id) ||
           std::any_of(in_use_.begin(), in_use_.end(),
                       [&](std::uint32_t place) { return slots_[place].use->id == id; }) ||
           std::any_of(reports_.begin(), reports_.end(), [id](const auto& r) { return r.id == id; });
}

} // namespace tactor::engine
