// SPDX-License-Identifier: MIT
#include "synth/wave/window.hpp"

#include <algorithm>

namespace tactor::synth {

namespace {

/// Returns the angle at frame k, in turns; `ramp` frames are half a turn. Reduces k as an integer, so that
/// the angle is exact.
double turns(std::int64_t k, std::uint64_t ramp) noexcept
{
    const auto period = static_cast<std::int64_t>(2 * ramp);
    return static_cast<double>(k % period) / static_cast<double>(period);
}

double ramp_cycles(std::uint64_t ramp) noexcept
{
    return 0.5 / static_cast<double>(ramp);
}

/// Range of the indices in lo ... hi for which from <= first + j < to.
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

/// Computes out[j] *= 0.5 + scale * cos(pi k / ramp) with k = first + j.
void apply_half_cosine(oscillator_tables& tables, std::int64_t first, std::uint64_t ramp, double scale,
                       part p, double* out) noexcept
{
    if (p.empty())
        return;
    const oscillator_table& t = tables.get(ramp_cycles(ramp));
    for_each_part(first, p.lo, p.hi, [&](const table_part& q) {
        apply_cosine_factor(t, sincos_turns(turns(q.base, ramp)), 0.5, scale, q, out);
    });
}

/// Returns exp(x) for -8 <= x <= 0, with the same bits on every machine: the Taylor series of x / 32, squared
/// five times.
double exponential(double x) noexcept
{
    const double z = x / 32.0;
    double y = 1.0;
    for (int i = 10; i > 0; --i)
        y = 1.0 + y * z / i;
    for (int i = 0; i < 5; ++i)
        y *= y;
    return y;
}

/// Number of time constants in an exponential ramp, which is scaled to reach its final value.
constexpr double time_constants = 5.0;
const double exponential_rest = exponential(-time_constants);

/// Returns frame k of an attack.
double rising(std::int64_t k, std::uint32_t frames, envelope_kind shape) noexcept
{
    const double part = static_cast<double>(k) / frames;
    switch (shape) {
    case envelope_kind::linear:
        return part;
    case envelope_kind::exponential:
        return (1.0 - exponential(-time_constants * part)) / (1.0 - exponential_rest);
    case envelope_kind::raised_cosine:
    case envelope_kind::tukey:
        break;
    }
    return 0.5 - 0.5 * sincos_turns(turns(k, frames)).cos;
}

/// Returns the window `remaining` frames before the end of a release. An exponential release falls fastest at
/// its start.
double falling(std::int64_t remaining, std::uint32_t frames, envelope_kind shape) noexcept
{
    return shape == envelope_kind::exponential ? 1.0 - rising(frames - remaining, frames, shape)
                                               : rising(remaining, frames, shape);
}

void zero(part p, double* out) noexcept
{
    if (!p.empty())
        std::fill(out + p.lo, out + p.hi, 0.0);
}

} // namespace

double window_at(std::int64_t k, const burst_window& w) noexcept
{
    const auto n = static_cast<std::int64_t>(w.length);
    if (k < 0 || k > n)
        return 0.0;
    if (k < static_cast<std::int64_t>(w.attack))
        return rising(k, w.attack, w.shape);
    return n - k < static_cast<std::int64_t>(w.release) ? falling(n - k, w.release, w.shape) : 1.0;
}

bool window_is_flat(std::int64_t from, std::int64_t to, const burst_window& w) noexcept
{
    return (w.attack == 0 && w.release == 0) || (from >= static_cast<std::int64_t>(w.attack) &&
                                                 to <= static_cast<std::int64_t>(w.length - w.release));
}

void window_block(oscillator_tables& tables, std::int64_t first, const burst_window& w, unsigned lo,
                  unsigned hi, double* out) noexcept
{
    if (w.attack == 0 && w.release == 0)
        return;
    const auto n = static_cast<std::int64_t>(w.length);
    const auto attack = static_cast<std::int64_t>(w.attack);
    const std::int64_t end = first + block_frames;
    const part rise(first, 0, std::min(attack, n), lo, hi);
    const part fall(first, std::max(attack, n - static_cast<std::int64_t>(w.release)), n, lo, hi);
    zero(part(first, first, 0, lo, hi), out);
    zero(part(first, n, std::max(end, n), lo, hi), out);
    if (w.shape == envelope_kind::raised_cosine || w.shape == envelope_kind::tukey) {
        apply_half_cosine(tables, first, w.attack, -0.5, rise, out);
        apply_half_cosine(tables, first - n, w.release, -0.5, fall, out);
        return;
    }
    for (unsigned j = rise.lo; j < rise.hi; ++j)
        out[j] *= rising(first + j, w.attack, w.shape);
    for (unsigned j = fall.lo; j < fall.hi; ++j)
        out[j] *= falling(n - (first + j), w.release, w.shape);
}

void fade_block(oscillator_tables& tables, std::int64_t first, std::uint64_t length, unsigned lo, unsigned hi,
                double* out) noexcept
{
    const auto n = static_cast<std::int64_t>(length);
    const part falling(first, 0, n, lo, hi);
    zero(part(first, n, std::max<std::int64_t>(first + block_frames, n), lo, hi), out);
    apply_half_cosine(tables, first, length, 0.5, falling, out);
}

} // namespace tactor::synth
