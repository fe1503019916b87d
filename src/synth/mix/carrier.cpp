// SPDX-License-Identifier: MIT
#include "synth/mix/carrier.hpp"

#include <algorithm>
#include <cstddef>

#include "core/clones.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::synth {

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
            sine_block(tables_.get(v.cycles_per_frame), v.cycles_per_frame, phase, n, e.plain.data(), w);
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

TACTOR_CLONES void add_constant(const double* s, double a, unsigned lo, unsigned hi, double* sum) noexcept
{
    const double* __restrict in = s;
    double* __restrict out = sum;
    for (unsigned j = lo; j < hi; ++j)
        out[j] += a * in[j];
}

TACTOR_CLONES void add_line(const double* s, double a, double slope, double k, unsigned lo, unsigned hi,
                            double* sum) noexcept
{
    const double* __restrict in = s;
    double* __restrict out = sum;
    for (int j = static_cast<int>(lo); j < static_cast<int>(hi); ++j)
        out[j] += (a + slope * (k + j)) * in[j];
}

} // namespace tactor::synth
