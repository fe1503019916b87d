// SPDX-License-Identifier: MIT
#include "synth/mix/voice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "core/clones.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::synth {
namespace {

// Returns the index of the first fade for which the test is true, or fades::none.
template <class Fades, class Test>
std::int32_t first(const Fades& all, Test test) noexcept
{
    const auto i = std::find_if(all.begin(), all.end(), test);
    return i == all.end() ? fades::none : static_cast<std::int32_t>(i - all.begin());
}

// Computes sum[j] += a * s[j] for lo <= j < hi.
TACTOR_CLONES void add_constant(const double* s, double a, unsigned lo, unsigned hi, double* sum) noexcept
{
    const double* __restrict in = s;
    double* __restrict out = sum;
    for (unsigned j = lo; j < hi; ++j)
        out[j] += a * in[j];
}

// Computes sum[j] += (a + slope * (k + j)) * s[j] for lo <= j < hi.
TACTOR_CLONES void add_line(const double* s, double a, double slope, double k, unsigned lo, unsigned hi,
                            double* sum) noexcept
{
    const double* __restrict in = s;
    double* __restrict out = sum;
    for (int j = static_cast<int>(lo); j < static_cast<int>(hi); ++j)
        out[j] += (a + slope * (k + j)) * in[j];
}

} // namespace

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

bool is_coherent(const voice& a, const voice& b) noexcept
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
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
}

void voice_list::activate(std::uint64_t before) noexcept
{
    while (!heap_.empty() && heap_.front().start < before) {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
        const std::uint32_t slot = heap_.back().slot;
        heap_.pop_back();
        const voice& v = voices_[slot];
        // Searches from the end, because only a late voice has others after it.
        auto place = active_.end();
        while (place != active_.begin()) {
            const voice& earlier = voices_[*(place - 1)];
            if (earlier.start < v.start || (earlier.start == v.start && earlier.order < v.order))
                break;
            --place;
        }
        active_.insert(place, slot);
        earliest_end_ = std::min(earliest_end_, v.end);
    }
}

std::uint64_t voice_list::next_start() const noexcept
{
    return heap_.empty() ? ~std::uint64_t{0} : heap_.front().start;
}

void voice_list::retire(std::uint64_t by) noexcept
{
    if (earliest_end_ <= by)
        remove_active_if([by](const voice& v) { return v.end <= by; });
}

void score_gain::apply(std::uint64_t frame, unsigned n, double* samples) const noexcept
{
    if (is_over(frame)) { // the usual case
        for (unsigned j = 0; j < n; ++j)
            samples[j] *= to;
        return;
    }
    for (unsigned j = 0; j < n; ++j)
        samples[j] *= at(frame + j);
}

const score_gain* score_gains::find(std::uint32_t score, std::uint64_t frame) const noexcept
{
    const std::size_t i = place(score);
    return i == used_ || (gains_[i].to == 1.0 && gains_[i].is_over(frame)) ? nullptr : &gains_[i];
}

bool score_gains::set(std::uint32_t score, double to, std::uint64_t at, std::uint64_t length) noexcept
{
    const std::size_t i = place(score);
    if (i == used_) {
        if (to == 1.0)
            return true;
        if (used_ == gains_.size())
            return false;
        gains_[used_++] = {};
    }
    score_gain& g = gains_[i];
    g = {.score = score, .from = length == 0 ? to : g.at(at), .to = to, .start = at, .length = length};
    return true;
}

void score_gains::forget(std::uint32_t score) noexcept
{
    if (const std::size_t i = place(score); i != used_)
        gains_[i] = gains_[--used_];
}

void score_gains::end_ramps() noexcept
{
    for (std::size_t i = 0; i < used_; ++i)
        gains_[i] = {.score = gains_[i].score, .from = gains_[i].to, .to = gains_[i].to};
}

std::int32_t fades::find(std::uint32_t score) const noexcept
{
    return any() ? first(fades_, [score](const fade& f) { return f.used && f.score == score; }) : none;
}

bool fades::any_ended(std::uint64_t by) const noexcept
{
    return any() && first(fades_, [by](const fade& f) { return f.used && f.end() <= by; }) != none;
}

void fades::end_all(std::uint64_t by) noexcept
{
    for (fade& f : fades_)
        if (f.used && f.end() <= by) {
            f.used = false;
            --used_;
        }
}

std::int32_t fades::begin(std::uint32_t score, std::uint64_t start, std::uint64_t length) noexcept
{
    const std::int32_t i =
        used_ == fades_.size() ? none : first(fades_, [](const fade& f) { return !f.used; });
    if (i != none) {
        fades_[static_cast<std::size_t>(i)] = {true, score, start, length};
        ++used_;
    }
    return i;
}

void fades::end(std::int32_t i) noexcept
{
    fades_[static_cast<std::size_t>(i)].used = false;
    --used_;
}

void fades::clear() noexcept
{
    fades_.fill({});
    used_ = 0;
}

void carrier_block::forget() noexcept
{
    for (entry& e : entries_) {
        e.plain_place = {};
        e.shaped_place = {};
    }
}

const double* carrier_block::get(const voice& v, const fade* f, const score_gain* g, std::uint64_t at,
                                 unsigned n, wave w) noexcept
{
    entry& e = entries_[static_cast<std::size_t>(w)];
    const place here{at, n, v.cycles_per_frame, v.phase, v.stroke_place, v.sound};
    const auto phase = static_cast<std::int64_t>(v.phase + at);
    const auto stroke_frame = static_cast<std::int64_t>(v.stroke_place + at);
    if (!(here == e.plain_place)) {
        if (v.sound == nullptr)
            fill_sine_block(tables_.get(v.cycles_per_frame), v.cycles_per_frame, phase, n, e.plain.data(), w);
        else
            v.sound->fill(stroke_frame, stroke_frame - phase, n, e.plain.data(), w);
        e.plain_place = here;
    }
    const auto first = static_cast<std::int64_t>(v.window_place + at);
    const bool modulated = v.sound != nullptr && v.sound->am_depth != 0.0;
    if (f == nullptr && g == nullptr && !modulated && window_is_flat(first, first + n, v.window))
        return e.plain.data();
    shape wanted{v.window_place, v.window, 0, 0, g == nullptr ? score_gain{} : *g};
    if (f != nullptr) {
        wanted.fade_place = static_cast<std::int64_t>(at - f->start);
        wanted.fade_length = f->length;
    }
    if (here == e.shaped_place && wanted == e.shaped_shape)
        return e.shaped.data();
    std::copy(e.plain.begin(), e.plain.begin() + n, e.shaped.begin());
    if (modulated)
        modulate_block(tables_, v.sound->am_cycles_per_frame, v.sound->am_depth, stroke_frame, n,
                       e.shaped.data());
    window_block(tables_, first, v.window, 0, n, e.shaped.data());
    if (f != nullptr)
        fade_block(tables_, wanted.fade_place, f->length, 0, n, e.shaped.data());
    if (g != nullptr)
        g->apply(at, n, e.shaped.data());
    e.shaped_place = here;
    e.shaped_shape = wanted;
    return e.shaped.data();
}

void add_stretch(const double* s, const stretch& p, std::uint64_t at, unsigned n, double* sum) noexcept
{
    const auto [from, to] = p.within(at, n);
    if (p.drive.slope == 0.0) {
        add_constant(s, p.drive.from, from, to, sum);
    } else {
        const auto k = static_cast<double>(static_cast<std::int64_t>(at - p.start));
        add_line(s, p.drive.from, p.drive.slope, k, from, to, sum);
    }
}

} // namespace tactor::synth
