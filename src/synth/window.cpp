// SPDX-License-Identifier: MIT
#include "synth/window.hpp"

#include <algorithm>

namespace tactor::synth {

namespace {

/// Half a turn each `ramp` frames. k is reduced as an integer, so the angle is exact.
double turns(std::int64_t k, std::uint64_t ramp) noexcept
{
    const auto period = static_cast<std::int64_t>(2 * ramp);
    return static_cast<double>(k % period) / static_cast<double>(period);
}

double cycles_of(std::uint64_t ramp) noexcept
{
    return 0.5 / static_cast<double>(ramp);
}

/// The part of lo ... hi where from <= first + j < to.
struct part {
    unsigned lo;
    unsigned hi;
    part(std::int64_t first, std::int64_t from, std::int64_t to, unsigned lo_, unsigned hi_) noexcept
        : lo(at(from - first, lo_, hi_)), hi(at(to - first, lo_, hi_))
    {
    }
    static unsigned at(std::int64_t j, unsigned lo_, unsigned hi_) noexcept
    {
        return static_cast<unsigned>(std::clamp<std::int64_t>(j, lo_, hi_));
    }
    bool empty() const noexcept { return lo >= hi; }
};

/// out[j] *= 0.5 + scale * cos(pi k / ramp) with k = first + j.
void half_cosine(oscillator_tables& tables, std::int64_t first, std::uint64_t ramp, double scale, part p,
                 double* out) noexcept
{
    if (p.empty()) {
        return;
    }
    const oscillator_table& t = tables.get(cycles_of(ramp));
    for_each_part(first, p.lo, p.hi, [&](const table_part& q) {
        times_cosine(t, sincos_cycles(turns(q.base, ramp)), 0.5, scale, q, out);
    });
}

void zero(part p, double* out) noexcept
{
    if (!p.empty()) {
        std::fill(out + p.lo, out + p.hi, 0.0);
    }
}

} // namespace

double window_at(std::int64_t k, std::uint64_t length, std::uint64_t ramp) noexcept
{
    const auto n = static_cast<std::int64_t>(length);
    const auto r = static_cast<std::int64_t>(ramp);
    if (k < 0 || k > n) {
        return 0.0;
    }
    const std::int64_t inside = std::min(k, n - k);
    return inside < r ? 0.5 - 0.5 * sincos_cycles(turns(inside, ramp)).cos : 1.0;
}

bool window_is_flat(std::int64_t from, std::int64_t to, std::uint64_t length, std::uint64_t ramp) noexcept
{
    return ramp == 0 ||
           (from >= static_cast<std::int64_t>(ramp) && to <= static_cast<std::int64_t>(length - ramp));
}

void window_block(oscillator_tables& tables, std::int64_t first, std::uint64_t length, std::uint64_t ramp,
                  unsigned lo, unsigned hi, double* out) noexcept
{
    if (ramp == 0) {
        return;
    }
    const auto n = static_cast<std::int64_t>(length);
    const auto r = static_cast<std::int64_t>(ramp);
    const std::int64_t end = first + block_frames;
    const part rise(first, 0, std::min(r, n), lo, hi);
    const part fall(first, std::max(r, n - r), n, lo, hi);
    zero(part(first, first, 0, lo, hi), out);
    zero(part(first, n, std::max(end, n), lo, hi), out);
    half_cosine(tables, first, ramp, -0.5, rise, out);
    half_cosine(tables, first - n, ramp, -0.5, fall, out);
}

void fade_block(oscillator_tables& tables, std::int64_t first, std::uint64_t length, unsigned lo, unsigned hi,
                double* out) noexcept
{
    const auto n = static_cast<std::int64_t>(length);
    const part falling(first, 0, n, lo, hi);
    zero(part(first, n, std::max<std::int64_t>(first + block_frames, n), lo, hi), out);
    half_cosine(tables, first, length, 0.5, falling, out);
}

} // namespace tactor::synth
