// SPDX-License-Identifier: MIT
// One block: the voices are summed by channel, held within the limits and written.
#include <algorithm>

#include "synth/mixer_impl.hpp"

namespace tactor::synth {

namespace {

/// The sum, where a lone voice stood in for it.
double* summed(strip& t, unsigned n) noexcept
{
    if (t.lone != nullptr) {
        set_constant(t.lone, t.gain, 0, n, t.sum.data());
        t.lone = nullptr;
    }
    return t.sum.data();
}

constexpr block ones = [] {
    block b{};
    b.fill(1.0);
    return b;
}();

} // namespace

void mixer::impl::segment(unsigned n, std::byte* out) noexcept
{
    voices.activate(position + n);
    const std::span<const std::uint32_t> active = voices.active();
    for (std::size_t i = 0; i < active.size(); ++i) {
        mix(voices[active[i]], i + 1 == active.size(), n);
    }
    guard(n);
    write(n, out);
}

// The carrier lasts until another voice asks for one: behind the last voice, until the block is written.
void mixer::impl::mix(const voice& v, bool last, unsigned n) noexcept
{
    const auto from = static_cast<unsigned>(std::max(v.start, position) - position);
    const auto to = static_cast<unsigned>(std::min(v.end, position + n) - position);
    const double* s = v.cycles_per_frame == 0.0
                          ? ones.data()
                          : carrier.get(v, v.fade == fades::none ? nullptr : &fading[v.fade], position, n);
    const auto k = static_cast<double>(static_cast<std::int64_t>(position - v.start));
    for (std::uint32_t i = 0; i < v.drives; ++i) {
        const voice_drive& d = v.drive[i];
        const double peak = d.peak(v.end - v.start);
        strip& t = strips[d.channel];
        if (t.spare && v.cycles_per_frame != 0.0) {
            limited += to - from; // there is no tactor that it could be meant for
            continue;
        }
        if (duty.on() && peak >= least_counted_drive && !t.spare) {
            duty.drive(d.channel, clock + from, clock + to);
        }
        if (!t.sounding) {
            t.sounding = true;
            t.peak = 0.0;
            t.until = 0;
            t.reach(from, to, peak);
            sounding.push_back(d.channel);
            if (d.slope == 0.0 && to - from == n) {
                t.lone = s;
                t.gain = d.from;
                if (!last) {
                    summed(t, n);
                }
                continue;
            }
            std::fill_n(t.sum.begin(), n, 0.0);
        } else {
            t.reach(from, to, peak);
        }
        double* sum = summed(t, n);
        if (d.slope == 0.0) {
            add_constant(s, d.from, from, to, sum);
        } else {
            add_line(s, d.from, d.slope, k, from, to, sum);
        }
    }
}

void mixer::impl::guard(unsigned n) noexcept
{
    double most = 0.0; // sum of squares
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare) {
            limit_block(summed(t, n), n, 1.0); // two markers at once are one
            continue;
        }
        if (!within_limit(t.peak, t.limit)) {
            limited += limit_block(summed(t, n), n, t.limit);
        }
        if (duty.on() && duty.acts(c, clock)) {
            duty.apply(c, clock, n, summed(t, n));
        }
        const double peak = t.peak < t.limit ? t.peak : t.limit;
        most += peak * peak;
    }
    if (power.passes(most)) {
        return;
    }
    powered.clear();
    for (const std::uint32_t c : sounding) {
        if (!strips[c].spare) {
            powered.push_back(summed(strips[c], n));
        }
    }
    power_limited += power.apply(powered, n);
}

void mixer::impl::write(unsigned n, std::byte* out) noexcept
{
    std::sort(sounding.begin(), sounding.end());
    samples.clear();
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.lone != nullptr) {
            samples.push_back({c, t.lone, t.gain});
        } else {
            samples.push_back({c, t.sum.data(), 1.0});
        }
        t.lone = nullptr;
        t.sounding = false;
    }
    sounding.clear();
    interleave(format, samples, strips.size(), n, out);
}

} // namespace tactor::synth
