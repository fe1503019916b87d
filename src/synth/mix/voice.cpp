// SPDX-License-Identifier: MIT
#include "synth/mix/voice.hpp"

#include <algorithm>
#include <cmath>

#include "synth/tone/timbre.hpp"

namespace tactor::synth {

voice make_voice(const drive_event& e, std::size_t channels) noexcept
{
    voice v;
    v.start = e.start;
    v.end = e.start + e.length;
    v.phase = e.phase_frame - e.start;
    v.stroke_place = e.sound != nullptr ? v.phase + e.phase_origin : 0;
    v.cycles_per_frame = e.cycles_per_frame;
    v.window_place = e.ramp_position - e.start;
    v.window = {e.window, e.ramp, e.release == as_ramp ? e.ramp : e.release, e.shape};
    v.score = e.score;
    v.sound = e.sound;
    if (!std::isfinite(e.cycles_per_frame) || e.length == 0)
        return v;
    if (e.points != 0) {
        const auto last = e.line.amplitude.begin() + e.points;
        if (e.line.channel < channels &&
            std::all_of(e.line.amplitude.begin(), last, [](double a) { return std::isfinite(a); })) {
            v.points = e.points;
            v.line = e.line;
        }
        return v;
    }
    for (std::uint32_t i = 0; i < std::min<std::uint32_t>(e.drives, drives_per_event); ++i) {
        const channel_drive& d = e.drive[i];
        const double slope = (d.to - d.from) / e.length;
        const bool silent = d.from == 0.0 && d.to == 0.0;
        if (d.channel < channels && std::isfinite(d.from) && std::isfinite(slope) && !silent)
            v.drive[v.drives++] = {d.from, slope, d.channel};
    }
    return v;
}

bool adds_up(const voice& a, const voice& b) noexcept
{
    if (a.cycles_per_frame != b.cycles_per_frame || a.sound != b.sound)
        return false;
    if (a.sound == nullptr || (a.sound->is_sine() && a.sound->course.empty()))
        return true;
    return a.stroke_place == b.stroke_place && (a.sound->is_sine() || a.phase == b.phase);
}

voice_list::voice_list(std::size_t capacity) : voices_(capacity)
{
    free_.reserve(capacity);
    heap_.reserve(capacity);
    active_.reserve(capacity);
    clear();
}

void voice_list::clear() noexcept
{
    heap_.clear();
    active_.clear();
    free_.clear();
    for (std::size_t i = voices_.size(); i-- > 0;)
        free_.push_back(static_cast<std::uint32_t>(i));
    earliest_end_ = ~std::uint64_t{0};
}

void voice_list::add(voice v) noexcept
{
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    v.order = arrivals_++;
    voices_[slot] = v;
    heap_.push_back({v.start, v.order, slot});
    std::push_heap(heap_.begin(), heap_.end(), later);
}

void voice_list::activate(std::uint64_t before) noexcept
{
    while (!heap_.empty() && heap_.front().start < before) {
        std::pop_heap(heap_.begin(), heap_.end(), later);
        insert(heap_.back().slot);
        heap_.pop_back();
    }
}

void voice_list::insert(std::uint32_t slot) noexcept
{
    // Searches from the end: only a late voice has others after it.
    const voice& v = voices_[slot];
    auto place = active_.end();
    while (place != active_.begin()) {
        const voice& before = voices_[*(place - 1)];
        if (before.start < v.start || (before.start == v.start && before.order < v.order))
            break;
        --place;
    }
    active_.insert(place, slot);
    earliest_end_ = std::min(earliest_end_, v.end);
}

std::uint64_t voice_list::next_start() const noexcept
{
    return heap_.empty() ? ~std::uint64_t{0} : heap_.front().start;
}

void voice_list::retire(std::uint64_t by) noexcept
{
    if (earliest_end_ <= by)
        forget_active([by](const voice& v) { return v.end <= by; });
}

void voice_list::heapify() noexcept
{
    std::make_heap(heap_.begin(), heap_.end(), later);
}

} // namespace tactor::synth
