// SPDX-License-Identifier: MIT
#include "synth/score/expander.hpp"

#include <algorithm>

#include "synth/score/frames.hpp"

namespace tactor::synth {

void expander::begin(const score::impl& s, std::size_t item_number, control_points* points)
{
    score_ = &s;
    item_ = &s.list.items[item_number];
    points_ = points;
    number_ = item_number;
    position_ = item_->start;
    step_end_ = item_->start;
    step_ = 0;
    next_ = 0;
    done_ = false;
    if (item_->kind == item_kind::continuous) {
        points_->rows.clear();
        points_->open = false;
        points_->seen = {};
        take_sample(0);
    }
    advance();
}

void expander::advance()
{
    switch (item_->kind) {
    case item_kind::burst:
        burst_event();
        break;
    case item_kind::joined:
        joined_event();
        break;
    case item_kind::continuous:
        continuous_event();
        break;
    case item_kind::marker:
        marker_event();
        break;
    }
}

/// Begins an event at a frame of the score.
void expander::stretch(std::uint64_t start, std::uint64_t length) noexcept
{
    const plan& p = score_->plans[item_->plan].plan;
    event_.start = start;
    event_.length = static_cast<std::uint32_t>(length);
    const std::uint64_t stroke = score_->starts[item_->plan];
    const std::uint64_t origin = score_->phase == phase_kind::burst ? item_->start : stroke;
    event_.phase_frame = start - origin;
    event_.phase_origin = origin - stroke;
    event_.cycles_per_frame = p.carrier_hz / score_->rate;
    event_.sound = score_->sounds[item_->plan].get();
    event_.ramp_position = start - item_->start;
    event_.window = item_->length;
    event_.ramp = item_->ramp;
    // Joined bursts have their members' envelopes already.
    event_.release = item_->kind == item_kind::joined
                         ? 0
                         : release_frames(score_->envelope, score_->rate, item_->length, item_->ramp);
    event_.shape = score_->envelope.kind;
    event_.drives = 0;
    event_.points = 0;
}

void expander::add(std::uint32_t tactor, double from, double to) noexcept
{
    const tactor_level& t = score_->tactors[tactor];
    event_.drive[event_.drives++] = {t.gain * from, t.gain * to, t.channel};
    if (!score_->measured.empty()) {
        channel_drive& d = event_.drive[event_.drives - 1];
        const double level = score_->equalised(tactor, item_->plan, item_->start); // that of its beginning
        d.from *= level;
        d.to *= level;
    }
}

void expander::burst_event() noexcept
{
    if (next_ == item_->count) {
        next_ = 0;
        position_ += event_.length;
    }
    if (position_ >= item_->end()) {
        done_ = true;
        return;
    }
    stretch(position_, std::min(item_->end() - position_, longest_event));
    for (; next_ < item_->count && event_.drives < drives_per_event; ++next_) {
        const item_list& list = score_->list;
        const double amplitude = list.drive_amplitudes[item_->first + next_];
        add(list.drive_tactors[item_->first + next_], amplitude, amplitude);
    }
}

void expander::joined_event() noexcept
{
    if (position_ >= item_->end()) {
        done_ = true;
        return;
    }
    const joined_stretch s =
        join_members(score_->list.members.data() + item_->first, item_->count, next_, position_,
                     score_->plans[item_->plan].plan.overlap, score_->envelope.kind);
    stretch(position_, s.end - position_);
    add(item_->tactor, s.from, s.to);
    position_ = s.end;
}

void expander::marker_event() noexcept
{
    if (position_ >= item_->end()) {
        done_ = true;
        return;
    }
    stretch(position_, item_->length);
    event_.cycles_per_frame = 0.0;
    event_.sound = nullptr;
    event_.ramp = event_.release = 0;
    event_.drive[event_.drives++] = {1.0, 1.0, item_->tactor};
    position_ = item_->end();
}

void expander::continuous_event()
{
    const control_points& c = *points_;
    while (c.open || next_ == c.rows.size()) {
        if (!next_points()) {
            done_ = true;
            return;
        }
    }
    draw(c.rows[next_++]);
}

/// Draws a tactor between the control points, up to where it has come down to zero.
void expander::draw(const control_points::row& r) noexcept
{
    const control_points& c = *points_;
    std::size_t points = c.count;
    while (points > 2 && r.amplitude[points - 1] == 0.0 && r.amplitude[points - 2] == 0.0)
        --points;
    stretch(position_, c.frame[points - 1]);
    event_.points = static_cast<std::uint32_t>(points);
    const tactor_level& t = score_->tactors[r.tactor];
    channel_line& l = event_.line;
    l.channel = t.channel;
    l.frame = c.frame;
    for (std::size_t i = 0; i < points; ++i) {
        l.amplitude[i] = t.gain * r.amplitude[i];
        if (!score_->measured.empty())
            l.amplitude[i] *= score_->equalised(r.tactor, item_->plan, position_ + c.frame[i]);
    }
}

} // namespace tactor::synth
