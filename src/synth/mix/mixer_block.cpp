// SPDX-License-Identifier: MIT
// Work on a block: voices are summed by channel, limited and written.
#include <algorithm>

#include "synth/mix/mixer_impl.hpp"

namespace tactor::synth {

namespace {

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
    for (std::size_t i = 0; i < active.size(); ++i)
        mix(voices[active[i]], i + 1 == active.size(), n);
    limit(n);
    if (!envelopes.empty())
        guard(n);
    write(n, out);
}

// Mixes a voice. Its carrier is valid until another voice requests one: after the last voice, until the block
// is written.
void mixer::impl::mix(const voice& v, bool last, unsigned n) noexcept
{
    const auto from = static_cast<unsigned>(std::max(v.start, position) - position);
    const auto to = static_cast<unsigned>(std::min(v.end, position + n) - position);
    const double* s = v.cycles_per_frame == 0.0 ? ones.data() : shaped(v, position, n, wave::sine);
    if (v.points != 0) {
        mix_line(v, s, n);
        return;
    }
    for (std::uint32_t i = 0; i < v.drives; ++i) {
        const voice_drive& d = v.drive[i];
        const double peak = d.peak(v.end - v.start);
        strip& t = strips[d.channel];
        if (t.spare && v.cycles_per_frame != 0.0) {
            limited += to - from; // the channel has no tactor
            continue;
        }
        if (!t.sounding) {
            begin_strip(d.channel, v, from);
            t.steady = d.slope == 0.0 && carrier.is_plain(s);
            t.reach(from, to, peak);
            if (d.slope == 0.0 && to - from == n) {
                t.lone = s;
                t.gain = d.from;
                if (!last)
                    t.summed(n);
                continue;
            }
            std::fill_n(t.sum.begin(), n, 0.0);
        } else {
            t.reach(from, to, peak);
            t.join(v);
        }
        add_stretch(s, {v.start, v.end, d}, position, n, t.summed(n));
    }
}

void mixer::impl::begin_strip(std::uint32_t channel, const voice& v, unsigned from) noexcept
{
    strip& t = strips[channel];
    t.sounding = true;
    t.since = from;
    t.first = &v;
    t.power = v.sound == nullptr ? 1.0 : v.sound->power;
    t.steady = false;
    t.beats = false;
    t.peak = 0.0;
    t.until = 0;
    sounding.push_back(channel);
}

// Mixes a line. Its part in the block counts with its greatest amplitude, from the voice's own start on, even
// if it is silent at first, because voices come in order of their start.
void mixer::impl::mix_line(const voice& v, const double* s, unsigned n) noexcept
{
    strip& t = strips[v.line.channel];
    const bool meant = !t.spare || v.cycles_per_frame == 0.0;
    const bool alone = !t.sounding;
    double* sum = alone ? t.sum.data() : t.summed(n);
    unsigned first = n;
    unsigned end = 0;
    double peak = 0.0;
    each_stretch(v, position, n, [&](const stretch& p) {
        const auto [from, to] = p.within(position, n);
        if (meant && !alone) {
            add_stretch(s, p, position, n, sum);
        } else if (meant) {
            std::fill(sum + end, sum + from, 0.0);
            set_stretch(s, p, position, n, sum);
        }
        first = std::min(first, from);
        end = to;
        peak = std::max(peak, p.drive.peak(p.end - p.start));
    });
    if (end == 0)
        return;
    if (!meant) {
        limited += end - first; // the channel has no tactor
        return;
    }
    if (alone) {
        std::fill(sum + end, sum + n, 0.0);
        begin_strip(v.line.channel, v, first);
    } else {
        t.join(v);
    }
    t.reach(static_cast<unsigned>(std::max(v.start, position) - position), end, peak);
}

void mixer::impl::limit(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare)
            limit_block(t.summed(n), n, 1.0); // two markers at once are one marker
        else if (!within_limit(t.peak, t.limit))
            limited += limit_block(t.summed(n), n, t.limit);
    }
}

void mixer::impl::write(unsigned n, std::byte* out) noexcept
{
    std::sort(sounding.begin(), sounding.end());
    samples.clear();
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.lone != nullptr)
            samples.push_back({c, t.lone, t.gain});
        else
            samples.push_back({c, t.sum.data(), 1.0});
        t.lone = nullptr;
        t.sounding = false;
    }
    sounding.clear();
    interleave(format, samples, strips.size(), n, out);
}

} // namespace tactor::synth
