// SPDX-License-Identifier: MIT
#include "synth/oscillator.hpp"

#include <limits>

namespace tactor::synth {

oscillator_tables::oscillator_tables() noexcept
{
    keys_.fill(std::numeric_limits<double>::quiet_NaN());
}

const oscillator_table& oscillator_tables::get(double cycles_per_frame) noexcept
{
    if (keys_[latest_] == cycles_per_frame) {
        return tables_[latest_];
    }
    for (std::size_t i = 0; i < places; ++i) {
        if (keys_[i] == cycles_per_frame) {
            latest_ = i;
            return tables_[i];
        }
    }
    latest_ = oldest_;
    oldest_ = (oldest_ + 1) % places;
    keys_[latest_] = cycles_per_frame;
    oscillator_table& t = tables_[latest_];
    for (unsigned j = 0; j < block_frames; ++j) {
        const sine_cosine v = sincos_cycles(cycles_per_frame * j);
        t.sin[j] = v.sin;
        t.cos[j] = v.cos;
    }
    return t;
}

void sine_block(const oscillator_table& t, sine_cosine base, unsigned lo, unsigned hi, double* out) noexcept
{
    const double* __restrict s = t.sin.data();
    const double* __restrict c = t.cos.data();
    double* __restrict o = out;
    for (unsigned j = lo; j < hi; ++j) {
        o[j] = base.sin * c[j] + base.cos * s[j];
    }
}

void times_cosine(const oscillator_table& t, sine_cosine base, double offset, double scale, unsigned lo,
                  unsigned hi, double* out) noexcept
{
    const double* __restrict s = t.sin.data();
    const double* __restrict c = t.cos.data();
    double* __restrict o = out;
    for (unsigned j = lo; j < hi; ++j) {
        o[j] *= offset + scale * (base.cos * c[j] - base.sin * s[j]);
    }
}

}  // namespace tactor::synth
