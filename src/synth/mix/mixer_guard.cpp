// SPDX-License-Identifier: MIT
// Limits on the power of all channels and on the drive time of each. Both use envelopes: the length of the
// vector of the samples and the same samples a quarter of a cycle later. If carriers beat on a channel, the
// power counts at the crests: a gain that followed the beat would be audible.
#include <algorithm>

#include "core/clones.hpp"
#include "synth/mix/mixer_impl.hpp"

namespace tactor::synth {

namespace {

/// Computes y[j] = x[j]^2 + y[j]^2, at most `most`; NaN becomes `most`.
TACTOR_CLONES void square_envelope(const double* x, double most, unsigned lo, unsigned hi, double* y) noexcept
{
    const double* __restrict in = x;
    double* __restrict out = y;
    for (unsigned j = lo; j < hi; ++j) {
        const double e = in[j] * in[j] + out[j] * out[j];
        out[j] = e < most ? e : most;
    }
}

} // namespace

void mixer::impl::guard(unsigned n) noexcept
{
    double most = 0.0; // sum of squares
    for (const std::uint32_t c : sounding) {
        const strip& t = strips[c];
        const double peak = t.peak < t.limit ? t.peak : t.limit;
        most += t.spare ? 0.0 : peak * peak * t.power;
    }
    const bool together = !power.passes(most);
    look_from(together, n);
    find_envelopes(n);
    if (duty.on())
        count_drive(n);
    if (power.on())
        find_beats(together ? 0 : n - 1, n);
    if (duty.on())
        cut(n);
    if (power.on())
        guard_power(together, n);
}

// Finds the first frame whose envelope is needed, because an envelope takes as long as the samples.
void mixer::impl::look_from(bool together, unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare)
            continue;
        const bool known = !duty.on() || t.steady || t.is_quiet();
        t.look = together || !known ? 0 : power.on() ? n - 1 : n;
        t.only_crests = t.beats && known && power.on();
        std::fill(envelopes[c].begin() + t.look, envelopes[c].begin() + n, 0.0);
    }
}

void mixer::impl::add_wave(const voice& v, const stretch& p, wave w, unsigned look, unsigned n,
                           double* sum) noexcept
{
    const std::uint64_t at = position + look;
    if (p.end <= at || p.start >= position + n)
        return;
    const double* s = shaped(v, at, n - look, w);
    add_stretch(s, p, at, n - look, sum);
}

void mixer::impl::find_envelopes(unsigned n) noexcept
{
    for (const std::uint32_t slot : voices.active()) {
        const voice& v = voices[slot];
        each_stretch(v, position, n, [&](const stretch& s) {
            const std::uint32_t c = s.drive.channel;
            const strip& t = strips[c];
            if (t.look < n && !t.only_crests)
                add_wave(v, s, wave::cosine, t.look, n, envelopes[c].data() + t.look);
        });
    }
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        double* y = envelopes[c].data();
        const double most = t.most();
        if (t.look + 1 == n && t.lone != nullptr) {
            const double x = t.gain * t.lone[t.look];
            square_envelope(&x, most, 0, 1, y + t.look);
        } else if (t.look < n) {
            square_envelope(t.summed(n), most, t.look, n, y);
        }
    }
}

void mixer::impl::count_drive(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        const strip& t = strips[c];
        if (t.spare || t.is_quiet())
            continue;
        if (t.steady)
            duty.drive(c, clock + t.since, clock + t.until);
        else
            duty.follow(c, clock, envelopes[c].data(), n);
    }
}

void mixer::impl::cut(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (!t.spare && duty.acts(c, clock, n))
            duty.apply(c, clock, n, t.summed(n), envelopes[c].data(), t.look);
    }
}

void mixer::impl::guard_power(bool together, unsigned n) noexcept
{
    powered.clear();
    for (const std::uint32_t c : sounding)
        if (!strips[c].spare)
            powered.push_back({c, strips[c].sum.data(), envelopes[c].data()});
    if (!together) {
        power.passed(powered, n);
        return;
    }
    for (const powered_channel& c : powered)
        strips[c.channel].summed(n);
    power_limited += power.apply(powered, n);
}

} // namespace tactor::synth
