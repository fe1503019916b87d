// SPDX-License-Identifier: MIT
#include "engine/audio/audio_loop.hpp"

#include <algorithm>
#include <tuple>

namespace tactor::engine {
namespace {

// Returns how many frames of a score come before frame `at`. The score starts at frame `base`.
std::uint64_t frames_until(std::uint64_t at, std::uint64_t base, std::uint64_t length) noexcept
{
    return at > base ? std::min(at - base, length) : 0;
}

} // namespace

score_table::entry* score_table::find(ticket t) noexcept
{
    entry& e = entries_[ticket_place(t)];
    return e.used && e.score == t ? &e : nullptr;
}

bool score_table::take_cancellation(ticket t) noexcept
{
    std::uint32_t& waiting = called_off_[ticket_place(t)];
    if (waiting == 0)
        return false;
    --waiting;
    return true;
}

void score_table::begin(const command& c, std::uint64_t offset) noexcept
{
    entry& e = entries_[ticket_place(c.score)];
    const std::uint64_t next = mixer_.position();
    const std::uint64_t base = c.at > offset ? std::max(c.at - offset, next) : next;
    e = {.score = c.score,
         .id = c.id,
         .base = base,
         .length = c.length,
         .finish = base + c.length,
         .fade = fade_,
         .used = true};
    ++used_;
    top_ = std::max(top_, ticket_place(c.score) + 1);
    update_gain(e, 0);
    link_.reports.push({.what = report::kind::begun, .score = c.score, .frame = offset + base});
    if (stopping_)
        end_entry(e, stop_state_, stop_reason_, 0, 0); // nothing may begin after a stop
}

void score_table::update_gain(entry& e, std::uint32_t ramp) noexcept
{
    const float gain = link_.gains.get(e.score);
    if (gain != e.gain && mixer_.set_gain(e.score, gain, ramp))
        e.gain = gain;
}

void score_table::update_gains() noexcept
{
    if (!link_.gains.take_change_flag())
        return;
    for (std::uint32_t i = 0; i < top_; ++i)
        // A live stroke is silent before its first point, so its gain can jump.
        if (entry& e = entries_[i]; e.used)
            update_gain(e, e.base == never ? 0 : ramp_);
}

void score_table::forget(entry& e) noexcept
{
    mixer_.forget_gain(e.score);
    e.used = false;
    --used_;
}

bool score_table::add(const command& c) noexcept
{
    entry* e = find(c.score);
    if (e == nullptr || e->fading || e->fade_wanted)
        return true;
    synth::drive_event d = c.drive;
    d.start += e->base;
    if (d.start < mixer_.position()) {
        // A burst that begins in the middle would be felt as a step.
        request_fade(*e, state_kind::interrupted, late_reason());
        return true;
    }
    if (mixer_.available() <= reserve_ || !mixer_.add(d)) {
        record_crowding();
        return false;
    }
    record_drive_end(*e, d);
    return true;
}

void score_table::record_crowding() noexcept
{
    full_until_ = mixer_.position() + crowd_frames;
}

reason_kind score_table::late_reason() const noexcept
{
    return mixer_.position() < full_until_ ? reason_kind::crowded : reason_kind::late;
}

// Records the end of a drive. If a drive ends before its window does, another drive must continue it, unless
// its amplitude ends at zero.
void score_table::record_drive_end(entry& e, const synth::drive_event& d) noexcept
{
    const std::uint64_t end = d.start + d.length;
    if (end < e.covered)
        return;
    const bool sounds = d.points != 0
                            ? d.line.amplitude[d.points - 1] != 0.0
                            : std::any_of(d.drive.begin(), d.drive.begin() + d.drives,
                                          [](const synth::channel_drive& c) { return c.to != 0.0; });
    const bool open = d.ramp_position + d.length < d.window && sounds;
    e.open = open || (e.open && end == e.covered);
    e.covered = end;
}

void score_table::fade_late_scores(std::uint64_t period) noexcept
{
    const std::uint64_t next = mixer_.position();
    for (std::uint32_t i = 0; i < top_; ++i) {
        entry& e = entries_[i];
        if (!e.used || !e.open || e.fed || e.fading || e.fade_wanted)
            continue;
        if (e.covered >= next + 2 * period) {
            e.ahead = true;
        } else if (e.ahead && e.base < next) {
            // Between one and two periods are left, because at least two were left at the last call. If
            // nothing is left, the score is already silent.
            e.fade = static_cast<std::uint32_t>(std::min<std::uint64_t>(fade_, e.covered - next));
            request_fade(e, state_kind::interrupted, late_reason());
        }
    }
}

void score_table::end(ticket t) noexcept
{
    if (entry* e = find(t))
        e->fed = true;
}

void score_table::cancel(ticket t) noexcept
{
    entry* e = find(t);
    if (e == nullptr) {
        // The score is over, or its begin is still in the command ring. Its place shows which, because no
        // ticket is used twice. Commands may stay in the ring for seconds, so the score is reported here, and
        // its begin is dropped when it comes.
        entry& place = entries_[ticket_place(t)];
        if (place.score == t)
            return;
        place.score = t;
        ++called_off_[ticket_place(t)];
        link_.reports.push({.what = report::kind::over, .score = t, .state = state_kind::cancelled});
        return;
    }
    request_fade(*e, state_kind::cancelled, reason_kind::none);
}

void score_table::request_fade(entry& e, state_kind s, reason_kind why) noexcept
{
    if (e.fading || e.fade_wanted)
        return;
    const std::uint64_t next = mixer_.position();
    if (e.live != nullptr && e.base == never) {
        end_entry(e, s, why, 0, 0);
        return;
    }
    if (e.live == nullptr && e.base >= next && e.length > 0 && mixer_.fade_out(e.score, 0)) {
        end_entry(e, s, why, 0, 0); // nothing of the score has been mixed yet
        return;
    }
    // The rest of the score is on its way to the DAC, so the score finishes. Needs `fed`, because no more
    // commands come for a cancelled score: it would wait for its last command for ever.
    if (e.finish <= next && e.fed && why != reason_kind::late && why != reason_kind::crowded &&
        why != reason_kind::plan)
        return;
    e.state = s;
    e.why = why;
    e.fade_wanted = true;
    fade(e);
}

void score_table::fade(entry& e) noexcept
{
    // A continuous live stroke has no drives beyond this period that the mixer could fade.
    const bool follows = e.live != nullptr && !e.live->plays_bursts();
    if (follows)
        e.live->fade(mixer_, e.fade);
    else if (!mixer_.fade_out(e.score, e.fade))
        return; // too many fades at once: try again in the next period
    close_live(e);
    e.fading = true;
    e.fade_wanted = false;
    e.finish = mixer_.position() + e.fade;
}

void score_table::stop(state_kind s, reason_kind why) noexcept
{
    stopping_ = true;
    stop_state_ = s;
    stop_reason_ = why;
    for (std::uint32_t i = 0; i < top_; ++i)
        if (entries_[i].used)
            request_fade(entries_[i], stop_state_, stop_reason_);
}

void score_table::mute() noexcept
{
    for (std::uint32_t i = 0; i < top_; ++i) {
        entry& e = entries_[i];
        if (!e.used || e.fading || e.fade_wanted || e.base == never)
            continue;
        if (e.base < mixer_.position() || stopping_) { // also true for each live stroke that has begun
            request_fade(e, state_kind::interrupted, reason_kind::muted);
        } else if (mixer_.fade_out(e.score, 0)) {
            link_.reports.push({.what = report::kind::returned, .score = e.score});
            forget(e);
        }
    }
}

// Records start times when the frame reaches the DAC, because the clock is most accurate then. Earlier the
// clock may be unknown; later it may have begun a new line.
void score_table::record_start_times(std::uint64_t played, std::uint64_t offset,
                                     const clock_line& clock) noexcept
{
    for (std::uint32_t i = 0; i < top_ && used_ != 0; ++i) {
        entry& e = entries_[i];
        if (!e.used || e.started || e.base >= played)
            continue;
        e.started = true;
        e.started_ns = clock.time_at(offset + e.base);
    }
}

void score_table::update(std::uint64_t played) noexcept
{
    for (std::uint32_t i = 0; i < top_ && used_ != 0; ++i) {
        entry& e = entries_[i];
        if (!e.used)
            continue;
        if (e.fade_wanted)
            fade(e);
        if (e.fade_wanted || played < e.finish)
            continue;
        if (e.fading)
            end_entry(e, e.state, e.why, 0, frames_until(e.finish, e.base, e.length));
        else if (e.fed)
            end_entry(e, state_kind::finished, reason_kind::none, 0, e.length);
    }
}

void score_table::interrupt(reason_kind why, int code, std::uint64_t played, bool give_back) noexcept
{
    full_until_ = 0; // frames count from 0 in the next epoch
    for (std::uint32_t i = 0; i < top_; ++i) {
        entry& e = entries_[i];
        if (!e.used)
            continue;
        if (give_back && e.base == never)
            continue; // a live stroke that waits for its first point continues to wait
        if (give_back && !e.fade_wanted &&
            e.base >= mixer_.position()) { // false for each live stroke that has begun
            link_.reports.push({.what = report::kind::returned, .score = e.score});
            forget(e);
            continue;
        }
        const std::uint64_t frames = frames_until(played, e.base, e.length);
        if (!e.fading && e.fed && frames == e.length)
            end_entry(e, state_kind::finished, reason_kind::none, 0, frames);
        else if ((e.fading || e.fade_wanted) && e.why == reason_kind::none)
            end_entry(e, e.state, e.why, 0, frames); // it was cancelled, and is silent now
        else
            end_entry(e, state_kind::interrupted, why == reason_kind::none ? e.why : why, code, frames);
    }
}

void score_table::end_entry(entry& e, state_kind s, reason_kind why, int code, std::uint64_t frames) noexcept
{
    close_live(e);
    if (e.sounds)
        --live_sounding_;
    e.sounds = false;
    const bool started = e.started && frames != 0;
    link_.reports.push(
        {.what = report::kind::over,
         .score = e.score,
         .state = s,
         .why = why,
         .code = code,
         .frame = frames,
         .started = started,
         .started_ns = e.started_ns,
         .delay = e.voice != nullptr && started ? e.voice->delay(e.started_ns) : live_delay{}});
    forget(e);
}

void score_table::describe(std::uint64_t played, stream_status& s) const noexcept
{
    const entry* newest = nullptr;
    for (std::uint32_t i = 0; i < top_; ++i) {
        const entry& e = entries_[i];
        if (!e.used || e.base >= mixer_.position())
            continue;
        s.sounds_until = std::max(s.sounds_until, e.fade_wanted ? never : e.finish);
        if (played < e.base || played >= e.base + e.length)
            continue;
        if (newest == nullptr || std::tie(e.base, e.id) > std::tie(newest->base, newest->id))
            newest = &e;
    }
    s.sounding = newest != nullptr;
    s.stroke = newest != nullptr ? newest->id : stroke_id{};
    s.stroke_frame = newest != nullptr ? played - newest->base : 0;
}

bool score_table::needs_drives() const noexcept
{
    const std::uint64_t next = mixer_.position();
    return std::any_of(entries_.begin(), entries_.begin() + top_,
                       [next](const entry& e) { return e.used && !e.fed && !e.fading && e.base <= next; });
}

void score_table::begin_live(const request& r) noexcept
{
    entry& e = entries_[ticket_place(r.score)];
    e = {.score = r.score,
         .id = r.id,
         .base = never,
         .length = never,
         .finish = 2 * never,
         .fade = fade_,
         .used = true,
         .fed = true,
         .live = r.voice,
         .voice = r.voice};
    ++used_;
    top_ = std::max(top_, ticket_place(r.score) + 1);
    live_[live_count_++] = &e;
    update_gain(e, 0);
    if (stopping_)
        end_entry(e, stop_state_, stop_reason_, 0, 0);
}

void score_table::handle_live_requests() noexcept
{
    // Goes backwards, because the entries after a closed one move up.
    for (std::size_t i = live_count_; i-- > 0;)
        handle_live_requests(*live_[i]);
}

void score_table::render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept
{
    handle_live_requests();
    // Goes forwards, so that the first stroke to begin sounds first. After a stroke has closed, the next one
    // is at index i.
    for (std::size_t i = 0; i < live_count_;) {
        entry& e = *live_[i];
        if (!e.fade_wanted)
            render_live(e, frames, offset, clock);
        if (e.live != nullptr)
            ++i;
    }
}

void score_table::handle_live_requests(entry& e) noexcept
{
    switch (e.live->requested()) {
    case live_voice::action::cancel:
        return request_fade(e, state_kind::cancelled, reason_kind::none);
    case live_voice::action::fail:
        return request_fade(e, state_kind::interrupted, reason_kind::plan);
    case live_voice::action::end:
        if (e.live->has_new_value() || (e.base == never && e.live->has_point()) ||
            e.live->moves(mixer_.position()))
            return; // the last point before the end counts, too
        break;
    case live_voice::action::go_on:
        if (e.live->starved())
            request_fade(e, state_kind::interrupted, reason_kind::starved);
        else if (e.live->reached_max_duration(mixer_.position()))
            request_fade(e, state_kind::interrupted, reason_kind::too_long);
        return;
    }
    if (e.base == never)
        return end_entry(e, state_kind::finished, reason_kind::none, 0, 0);
    if (!e.live->plays_bursts())
        e.live->fade(mixer_, fade_);
    e.finish = std::max(e.live->end(), mixer_.position());
    e.length = e.finish - e.base;
    close_live(e);
}

void score_table::render_live(entry& e, std::uint64_t frames, std::uint64_t offset,
                              const clock_line& clock) noexcept
{
    if (e.base == never) {
        e.live->wait(frames);
        if (!link_.amplifier.ready.load(std::memory_order_acquire))
            return; // the amplifier is off
        if (live_sounding_ == live_voices || !e.live->try_begin(e.score, mixer_.position()))
            return;
        e.sounds = true;
        ++live_sounding_;
        e.base = mixer_.position();
        link_.reports.push({.what = report::kind::begun, .score = e.score, .frame = offset + e.base});
    }
    if (!e.live->render(mixer_, frames, offset, clock))
        request_fade(e, state_kind::interrupted, reason_kind::late);
}

void score_table::close_live(entry& e) noexcept
{
    if (e.live == nullptr)
        return;
    e.live->close();
    e.live = nullptr;
    const auto end = live_.begin() + live_count_;
    const auto found = std::find(live_.begin(), end, &e);
    std::move(found + 1, end, found);
    --live_count_;
}

} // namespace tactor::engine
