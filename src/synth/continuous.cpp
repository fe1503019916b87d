// SPDX-License-Identifier: MIT
#include <algorithm>

#include "synth/expander.hpp"
#include "synth/frames.hpp"

namespace tactor::synth {

void control_points::reserve(std::size_t tactors)
{
    before.reserve(tactors);
    changes.reserve(tactors);
    now.drives.reserve(tactors);
}

std::uint64_t control_frame(std::uint64_t k, unsigned rate, std::uint64_t length) noexcept
{
    return std::min(length, frame_at(static_cast<double>(k) * continuous_step_s, rate));
}

void drives_at(const plan& p, double t_s, std::size_t tactors, burst& out) noexcept
{
    // Called where nothing may be thrown; the score's constructor has tried it and told of failures.
    try {
        p.at(std::min(t_s, p.stroke_duration_s), out);
    } catch (...) {
        out.drives.clear();
    }
    std::erase_if(out.drives, [tactors](const drive& d) { return d.tactor >= tactors; });
    const auto by_tactor = [](const drive& a, const drive& b) { return a.tactor < b.tactor; };
    if (!std::is_sorted(out.drives.begin(), out.drives.end(), by_tactor)) {
        std::sort(out.drives.begin(), out.drives.end(), by_tactor);
    }
    const auto same = [](const drive& a, const drive& b) { return a.tactor == b.tactor; };
    out.drives.erase(std::unique(out.drives.begin(), out.drives.end(), same), out.drives.end());
}

/// Moves on to the next two control points; tactors that are in one of them only come from or go to 0.
bool expander::next_points() noexcept
{
    position_ = step_end_;
    if (position_ >= item_->end()) {
        return false;
    }
    while (step_end_ == position_) {
        step_end_ = item_->start + control_frame(++step_, score_->rate, item_->length);
    }
    control_points& c = *points_;
    std::swap(c.before, c.now.drives);
    drives_at(score_->plans[item_->plan].schedule, static_cast<double>(step_) * continuous_step_s,
              score_->tactors.size(), c.now);
    c.changes.clear();
    next_ = 0;
    auto a = c.before.cbegin();
    auto b = c.now.drives.cbegin();
    while (a != c.before.cend() || b != c.now.drives.cend()) {
        if (b == c.now.drives.cend() || (a != c.before.cend() && a->tactor < b->tactor)) {
            c.changes.push_back({a->tactor, a->amplitude, 0.0});
            ++a;
        } else if (a == c.before.cend() || b->tactor < a->tactor) {
            c.changes.push_back({b->tactor, 0.0, b->amplitude});
            ++b;
        } else {
            c.changes.push_back({a->tactor, a->amplitude, b->amplitude});
            ++a;
            ++b;
        }
    }
    return true;
}

} // namespace tactor::synth
