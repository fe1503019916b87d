// SPDX-License-Identifier: MIT
#include <algorithm>

#include "synth/score/expander.hpp"
#include "synth/score/frames.hpp"

namespace tactor::synth {

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

std::uint64_t control_frame(std::uint64_t k, unsigned rate, std::uint64_t length) noexcept
{
    return std::min(length, frame_at(static_cast<double>(k) * continuous_step_s, rate));
}

/// Replaces points()->now by control point number `step`. Throws std::bad_alloc.
void expander::take_sample(std::uint64_t step)
{
    control_points& c = *points_;
    curve_access::of(*score_->plans[item_->plan].plan.curve).sample(step, c.seen, c.now);
}

/// Moves on to the next control points; false at the end. Where this throws, it is called again, and goes on
/// with the point that is missing.
bool expander::next_points()
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

} // namespace tactor::synth
