// SPDX-License-Identifier: MIT
#include "synth/score/event_source.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/access.hpp"
#include "synth/score/frames.hpp"
#include "synth/tone/own_samples.hpp"
#include "synth/wave/window.hpp"

namespace tactor::synth {
namespace {

/// Number of linear steps of a ramp. The error is below 0.2 %. At up to 48 kHz the default ramp is exact: a
/// step is one frame.
constexpr std::uint32_t ramp_steps = 64;

/// Returns the next frame after `at` at which a linear step of this member's window ends, or the member's
/// start if it has not begun.
std::uint64_t next_break(const item_member& m, std::uint64_t at) noexcept
{
    if (at < m.start)
        return m.start;
    const std::uint64_t step = std::max<std::uint64_t>(1, m.ramp / ramp_steps);
    const std::uint64_t k = at - m.start;
    const std::uint64_t fall = m.length - m.release;
    const std::uint64_t fall_step = std::max<std::uint64_t>(1, m.release / ramp_steps);
    if (k < m.ramp)
        return m.start + std::min<std::uint64_t>(m.ramp, (k / step + 1) * step);
    if (k < fall)
        return m.start + fall;
    return m.start + std::min(m.length, fall + ((k - fall) / fall_step + 1) * fall_step);
}

/// Returns the amplitude at frame `at` of the members that sound at frame `inside`.
double amplitude(const item_member* first, const item_member* last, std::uint64_t inside, std::uint64_t at,
                 overlap_kind rule, envelope_kind shape) noexcept
{
    double energy = 0.0;
    double sum = 0.0;
    double largest = 0.0;
    double intensity = 0.0;
    for (const item_member* m = first; m != last; ++m) {
        if (inside < m->start || inside >= m->end())
            continue;
        const double a = m->amplitude * window_at(static_cast<std::int64_t>(at - m->start),
                                                  {m->length, m->ramp, m->release, shape});
        energy += a * a;
        sum += a;
        largest = std::max(largest, a);
        intensity = std::max(intensity, m->intensity);
    }
    switch (rule) {
    case overlap_kind::max:
        return largest;
    case overlap_kind::sum:
        return sum;
    case overlap_kind::energy:
        break;
    }
    return std::min(intensity, std::sqrt(energy));
}

/// Linear piece of the amplitude of a group's carrier.
struct joined_stretch {
    std::uint64_t end = 0;
    double from = 0.0;
    double to = 0.0;
};

/// Returns the stretch from frame `at` on whose amplitude is treated as linear: up to the next start or end
/// of a member, and within ramps up to the next 64th of the ramp. Moves `first` past the members that have
/// ended.
joined_stretch join_members(const item_member* members, std::size_t count, std::size_t& first,
                            std::uint64_t at, overlap_kind rule, envelope_kind shape) noexcept
{
    while (first + 1 < count && members[first].end() <= at)
        ++first;
    joined_stretch s;
    s.end = at + longest_event;
    std::size_t last = first;
    for (; last < count; ++last) {
        const item_member& m = members[last];
        if (m.end() > at)
            s.end = std::min(s.end, next_break(m, at));
        if (m.start > at)
            break;
    }
    s.from = amplitude(members + first, members + last, at, at, rule, shape);
    s.to = amplitude(members + first, members + last, at, s.end, rule, shape);
    return s;
}

/// Returns the frame of control point k of a stroke of `length` frames, from its start. Points beyond the end
/// are at the end.
std::uint64_t control_frame(std::uint64_t k, unsigned rate, std::uint64_t length) noexcept
{
    return std::min(length, frame_at(static_cast<double>(k) * continuous_step_s, rate));
}

/// Order of the heap of a source: by start, then by item.
constexpr auto later = [](const expander* a, const expander* b) noexcept {
    return a->event().start != b->event().start ? a->event().start > b->event().start
                                                : a->item_number() > b->item_number();
};

} // namespace

void expander::begin(const score::impl& s, std::size_t item_number, control_points* points,
                     std::uint64_t shift)
{
    score_ = &s;
    shift_ = shift;
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
        make_burst_event();
        break;
    case item_kind::joined:
        make_joined_event();
        break;
    case item_kind::continuous:
        continuous_event();
        break;
    case item_kind::marker:
        make_marker_event();
        break;
    case item_kind::own:
        make_own_event();
        break;
    }
}

/// Begins an event at a frame of the score.
void expander::stretch(std::uint64_t start, std::uint64_t length) noexcept
{
    const plan& p = score_->plans[item_->plan].plan;
    event_.start = start + shift_;
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
    // Joined bursts already contain their members' envelopes.
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
        const double level =
            score_->equalising_factor(tactor, item_->plan, item_->start); // level at the start
        d.from *= level;
        d.to *= level;
    }
}

void expander::make_burst_event() noexcept
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

void expander::make_joined_event() noexcept
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

void expander::make_marker_event() noexcept
{
    if (position_ >= item_->end()) {
        done_ = true;
        return;
    }
    stretch(position_, item_->length);
    event_.cycles_per_frame = 0.0;
    event_.sound = nullptr;
    event_.ramp = event_.release = 0;
    event_.drive[event_.drives++] = {score_->marker_level, score_->marker_level, item_->tactor};
    position_ = item_->end();
}

void expander::make_own_event() noexcept
{
    if (position_ >= item_->end()) {
        done_ = true;
        return;
    }
    stretch(position_, item_->length);
    event_.sound = score_->sounds[item_->first].get();
    if (score_->limits[item_->tactor] == 0.0)
        event_.cycles_per_frame = 0.0; // the channel has no tactor
    const double unit = event_.sound->own->unit;
    event_.drive[event_.drives++] = {unit, unit, item_->tactor};
    position_ = item_->end();
}

void expander::continuous_event()
{
    const control_points& c = *points_;
    while (c.open || next_ == c.rows.size()) {
        if (!advance_points()) {
            done_ = true;
            return;
        }
    }
    draw(c.rows[next_++]);
}

/// Adds the event of a tactor between the control points, up to the point from which its amplitude stays
/// zero.
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
            l.amplitude[i] *= score_->equalising_factor(r.tactor, item_->plan, position_ + c.frame[i]);
    }
}

void control_points::reserve(std::size_t tactors)
{
    rows.reserve(tactors);
    now.drives.reserve(tactors);
}

void control_points::add(std::size_t i) noexcept
{
    auto r = rows.begin();
    for (const drive& d : now.drives) {
        while (r != rows.end() && r->tactor < d.tactor)
            ++r;
        if (r == rows.end() || r->tactor != d.tactor) {
            if (d.amplitude == 0.0)
                continue;
            r = rows.insert(r, {d.tactor, {}});
        }
        r->amplitude[i] = d.amplitude;
        ++r;
    }
}

/// Replaces points()->now by control point number `step`. Throws std::bad_alloc.
void expander::take_sample(std::uint64_t step)
{
    control_points& c = *points_;
    curve_access::of(*score_->plans[item_->plan].plan.curve).sample(step, c.seen, c.now);
}

/// Moves on to the next control points; false at the end. After an exception, call it again: it continues
/// with the missing point.
bool expander::advance_points()
{
    control_points& c = *points_;
    if (!c.open) {
        position_ = step_end_;
        next_ = 0;
        c.rows.clear();
        if (position_ >= item_->end())
            return false;
        c.frame[0] = 0;
        c.add(0);
        c.count = 1;
        c.open = true;
    }
    while (c.count < points_per_line && step_end_ < item_->end()) {
        std::uint64_t step = step_;
        std::uint64_t end = step_end_;
        while (end == step_end_)
            end = item_->start + control_frame(++step, score_->rate, item_->length);
        take_sample(step);
        step_ = step;
        step_end_ = end;
        c.frame[c.count] = static_cast<std::uint16_t>(step_end_ - position_);
        c.add(c.count++);
    }
    c.open = false;
    return true;
}

event_source::event_source(const score& s)
    : piece_(detail::access::shared(s)),
      part_(piece_.get()),
      expanders_(piece_->open_items),
      points_(piece_->open_continuous)
{
    free_expanders_.reserve(expanders_.size());
    for (expander& e : expanders_)
        free_expanders_.push_back(&e);
    free_points_.reserve(points_.size());
    for (control_points& p : points_) {
        p.reserve(piece_->tactors.size());
        free_points_.push_back(&p);
    }
    heap_.reserve(expanders_.size());
}

/// Begins every item that may have the next event.
void event_source::begin_items()
{
    const std::deque<item>& items = part_->list.items;
    while (next_item_ < items.size() &&
           (heap_.empty() || items[next_item_].start + shift_ <= heap_.front()->event().start)) {
        const bool is_continuous = items[next_item_].kind == item_kind::continuous;
        expander* e = free_expanders_.back();
        e->begin(*part_, next_item_, is_continuous ? free_points_.back() : nullptr, shift_);
        ++next_item_;
        free_expanders_.pop_back();
        if (is_continuous)
            free_points_.pop_back();
        if (e->done()) {
            release(e);
            continue;
        }
        heap_.push_back(e);
        std::push_heap(heap_.begin(), heap_.end(), later);
    }
}

/// Advances the expander of the first event, and restores the order of the heap.
void event_source::advance_expander()
{
    expander* e = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), later);
    try {
        e->advance();
    } catch (...) { // the expander still has that event
        std::push_heap(heap_.begin(), heap_.end(), later);
        throw;
    }
    popped_ = false;
    if (e->done()) {
        heap_.pop_back();
        release(e);
    } else {
        std::push_heap(heap_.begin(), heap_.end(), later);
    }
}

/// Adds a finished expander and its control points to the free ones.
void event_source::release(expander* e) noexcept
{
    free_expanders_.push_back(e);
    if (e->points() != nullptr)
        free_points_.push_back(e->points());
}

const drive_event* event_source::peek()
{
    if (popped_)
        advance_expander();
    begin_items();
    for (; heap_.empty() && next_part_ < piece_->parts.size(); ++next_part_) {
        part_ = piece_->parts[next_part_].made.get();
        shift_ = piece_->parts[next_part_].start;
        next_item_ = 0;
        begin_items();
    }
    return heap_.empty() ? nullptr : &heap_.front()->event();
}

void event_source::pop() noexcept
{
    popped_ = !heap_.empty();
}

} // namespace tactor::synth
