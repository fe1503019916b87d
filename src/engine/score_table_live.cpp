// SPDX-License-Identifier: MIT
// The strokes among the scores that are fed while they sound.
#include <algorithm>

#include "engine/score_table.hpp"

namespace tactor::engine {

bool score_table::begin_live(const command& c) noexcept
{
    if (live_count_ == live_.size())
        return false;
    entry& e = entries_[place_of(c.score)];
    const bool cancelled = e.cancelled_early == c.score;
    e = {.score = c.score,
         .id = c.id,
         .base = never,
         .length = never,
         .finish = 2 * never,
         .fade = fade_,
         .used = true,
         .fed = true,
         .live = c.voice};
    ++used_;
    top_ = std::max(top_, place_of(c.score) + 1);
    live_[live_count_++] = &e;
    settle(e, cancelled);
    return true;
}

void score_table::render_live(std::uint64_t frames, std::uint64_t offset) noexcept
{
    // From the end, as an entry that closes is replaced by the last.
    for (std::size_t i = live_count_; i-- > 0;) {
        entry& e = *live_[i];
        look_at_wishes(e);
        if (e.live != nullptr && !e.fade_wanted)
            render_live(e, frames, offset);
    }
}

void score_table::look_at_wishes(entry& e) noexcept
{
    switch (e.live->asked()) {
    case live_voice::wish::cancel:
        return want_fade(e, stroke_state::cancelled, reason::none);
    case live_voice::wish::end:
        if (e.live->has_news())
            return; // the last point before the end counts too
        break;
    case live_voice::wish::go_on:
        if (e.base != never && e.live->starved())
            want_fade(e, stroke_state::interrupted, reason::starved);
        return;
    }
    if (e.base == never)
        return over(e, stroke_state::finished, reason::none, 0, 0);
    if (!e.live->is_bursts())
        e.live->fade(mixer_, fade_);
    e.finish = std::max(e.live->end(), mixer_.position());
    e.length = e.finish - e.base;
    close_live(e);
}

void score_table::render_live(entry& e, std::uint64_t frames, std::uint64_t offset) noexcept
{
    if (e.base == never) {
        if (!link_.amplifier.ready.load(std::memory_order_acquire))
            return; // not into an amplifier that is off
        if (!e.live->try_begin(e.score, mixer_.position()))
            return;
        e.base = mixer_.position();
        link_.reports.push({.what = report::kind::begun, .score = e.score, .frame = offset + e.base});
    }
    if (!e.live->render(mixer_, frames))
        want_fade(e, stroke_state::interrupted, reason::late);
}

void score_table::close_live(entry& e) noexcept
{
    if (e.live == nullptr)
        return;
    e.live->close();
    e.live = nullptr;
    const auto found = std::find(live_.begin(), live_.begin() + live_count_, &e);
    *found = live_[--live_count_];
}

} // namespace tactor::engine
