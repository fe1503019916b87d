// SPDX-License-Identifier: MIT
// Envelope at the crests of carriers that beat on a channel, for the limit on the power. An envelope that
// followed the beat would give an audible gain. Carriers of one frequency add up with their phases.
#include <algorithm>
#include <cmath>

#include "core/clones.hpp"
#include "synth/mix/mixer_impl.hpp"

namespace tactor::synth {

namespace {

/// Adds the length of (x, y) to `reach`, whose square is `square`, and clears x and y.
TACTOR_CLONES void add_length(unsigned n, double* x, double* y, double* reach, double* square) noexcept
{
    double* __restrict sine = x;
    double* __restrict cosine = y;
    double* __restrict sum = reach;
    double* __restrict out = square;
    for (unsigned j = 0; j < n; ++j) {
        const double e = sine[j] * sine[j] + cosine[j] * cosine[j];
        const double length = std::sqrt(e);
        out[j] += e + 2.0 * sum[j] * length;
        sum[j] += length;
        sine[j] = 0.0;
        cosine[j] = 0.0;
    }
}

} // namespace

void mixer::impl::find_beats(unsigned from, unsigned n) noexcept
{
    list_carriers();
    if (carriers.empty())
        return;
    for (const std::uint32_t c : sounding) {
        strips[c].summed(n); // a single voice's sine would be lost
        if (strips[c].beats)
            std::fill(envelopes[c].begin() + from, envelopes[c].begin() + n, 0.0);
    }
    while (from < n) {
        const unsigned to = std::min(n, from + static_cast<unsigned>(crest::frames));
        find_crests(from, to);
        from = to;
    }
}

/// Lists the voices on channels that beat, by frequency.
void mixer::impl::list_carriers() noexcept
{
    carriers.clear();
    const std::span<const std::uint32_t> active = voices.active();
    for (std::uint32_t i = 0; i < active.size(); ++i) {
        const voice& v = voices[active[i]];
        bool beats = false;
        each_channel(v, [&](std::uint32_t c) { beats = beats || strips[c].beats; });
        if (beats)
            carriers.emplace_back(v.cycles_per_frame, i);
    }
    std::sort(carriers.begin(), carriers.end());
}

void mixer::impl::find_crests(unsigned from, unsigned to) noexcept
{
    for (const std::uint32_t c : sounding)
        if (strips[c].beats)
            crests[c].reach.fill(0.0);
    for (std::size_t i = 0; i < carriers.size(); ++i) {
        const voice& v = voices[voices.active()[carriers[i].second]];
        each_stretch(v, position + from, to - from, [&](const stretch& s) {
            const std::uint32_t c = s.drive.channel;
            if (strips[c].beats) {
                crests[c].touched = true;
                add_wave(v, s, wave::sine, from, to, crests[c].x.data());
                add_wave(v, s, wave::cosine, from, to, crests[c].y.data());
            }
        });
        if (i + 1 == carriers.size() || !adds_up(v, voices[voices.active()[carriers[i + 1].second]]))
            add_carrier(from, to);
    }
    for (const std::uint32_t c : sounding) {
        if (strips[c].beats) {
            const double most = strips[c].most();
            double* square = envelopes[c].data();
            std::transform(square + from, square + to, square + from,
                           [most](double e) { return e < most ? e : most; });
        }
    }
}

void mixer::impl::add_carrier(unsigned from, unsigned to) noexcept
{
    for (const std::uint32_t c : sounding) {
        crest& r = crests[c];
        if (r.touched) {
            add_length(to - from, r.x.data(), r.y.data(), r.reach.data(), envelopes[c].data() + from);
            r.touched = false;
        }
    }
}

} // namespace tactor::synth
