// SPDX-License-Identifier: MIT
// Live strokes among the scores.
#include <algorithm>

#include "engine/audio/score_table.hpp"

namespace tactor::engine {

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
    follow_gain(e, 0);
    if (stopping_)
        over(e, stop_state_, stop_reason_, 0, 0);
}

void score_table::handle_live_requests() noexcept
{
    // Goes backwards, because entries behind one that closes move up.
    for (std::size_t i = live_count_; i-- > 0;)
        handle_live_requests(*live_[i]);
}

void score_table::render_live(std::uint64_t frames, std::uint64_t offset, const clock_line& clock) noexcept
{
    handle_live_requests();
    // In order, so that the first to begin sounds first. A stroke that closes now makes way for the next.
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
        return want_fade(e, state_kind::cancelled, reason_kind::none);
    case live_voice::action::fail:
        return want_fade(e, state_kind::interrupted, reason_kind::plan);
    case live_voice::action::end:
        if (e.live->has_news() || (e.base == never && e.live->has_point()) ||
            e.live->moves(mixer_.position()))
            return; // the last point before the end counts, too
        break;
    case live_voice::action::go_on:
        if (e.live->starved())
            want_fade(e, state_kind::interrupted, reason_kind::starved);
        else if (e.live->lasted(mixer_.position()))
            want_fade(e, state_kind::interrupted, reason_kind::too_long);
        return;
    }
    if (e.base == never)
        return over(e, state_kind::finished, reason_kind::none, 0, 0);
    if (!e.live->is_bursts())
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
        want_fade(e, state_kind::interrupted, reason_kind::late);
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
