// SPDX-License-Identifier: MIT
#include "synth/oscillator.hpp"

#include <bit>
#include <limits>

#include "synth/clones.hpp"

namespace tactor::synth {

namespace {

/// Spreads the bits of a frequency over `rows`: Knuth's multiplicative hash.
std::size_t row_of(double cycles_per_frame, std::size_t rows) noexcept
{
    return static_cast<std::size_t>((std::bit_cast<std::uint64_t>(cycles_per_frame) * 0x9E3779B97F4A7C15U) >>
                                    40) %
           rows;
}

void fill(oscillator_table& t, double cycles_per_frame) noexcept
{
    for (unsigned j = 0; j < table_frames; ++j) {
        const sine_cosine v = sincos_cycles(cycles_per_frame * j);
        t.sin[j] = v.sin;
        t.cos[j] = v.cos;
    }
}

} // namespace

oscillator_tables::oscillator_tables() : tables_(rows * places)
{
    for (row& r : rows_) {
        r.keys.fill(std::numeric_limits<double>::quiet_NaN());
    }
}

const oscillator_table& oscillator_tables::get(double cycles_per_frame) noexcept
{
    const std::size_t number = row_of(cycles_per_frame, rows);
    row& r = rows_[number];
    for (std::size_t i = 0; i < places; ++i) {
        if (r.keys[i] == cycles_per_frame) {
            return tables_[number * places + i];
        }
    }
    const std::size_t i = r.oldest;
    r.oldest = (i + 1) % places;
    r.keys[i] = cycles_per_frame;
    oscillator_table& t = tables_[number * places + i];
    fill(t, cycles_per_frame);
    return t;
}

TACTOR_CLONES void sine_block(const oscillator_table& t, sine_cosine base, const table_part& p,
                              double* out) noexcept
{
    const double* __restrict s = t.sin.data() + p.offset;
    const double* __restrict c = t.cos.data() + p.offset;
    double* __restrict o = out + p.lo;
    const unsigned n = p.hi - p.lo;
    for (unsigned j = 0; j < n; ++j) {
        o[j] = base.sin * c[j] + base.cos * s[j];
    }
}

TACTOR_CLONES void times_cosine(const oscillator_table& t, sine_cosine base, double offset, double scale,
                                const table_part& p, double* out) noexcept
{
    const double* __restrict s = t.sin.data() + p.offset;
    const double* __restrict c = t.cos.data() + p.offset;
    double* __restrict o = out + p.lo;
    const unsigned n = p.hi - p.lo;
    for (unsigned j = 0; j < n; ++j) {
        o[j] *= offset + scale * (base.cos * c[j] - base.sin * s[j]);
    }
}

} // namespace tactor::synth
