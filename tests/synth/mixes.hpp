// SPDX-License-Identifier: MIT
/// \file
/// Strokes mixed at random: bursts from a frame in length, each rule of overlap, carriers, waves, rates,
/// ramps, gains and limits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <tactor/render.hpp>

#include "pieces.hpp"
#include "plan/curve_impl.hpp"

namespace mixes {

using namespace tactor;

/// A generator that gives the same numbers for a seed with any standard library.
class dice {
public:
    explicit dice(std::uint64_t seed) : random_(seed) {}

    double from_to(double low, double high)
    {
        return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
    }
    int up_to(int most) { return static_cast<int>(random_() % (static_cast<std::uint64_t>(most) + 1)); }
    bool one_in(int n) { return up_to(n - 1) == 0; }
    template <class T>
    T pick(std::initializer_list<T> all)
    {
        return *(all.begin() + up_to(static_cast<int>(all.size()) - 1));
    }

private:
    std::mt19937_64 random_;
};

struct mix {
    array tactors;
    std::vector<placed_plan> plans;
    render_options options;
};

inline array some_array(dice& d)
{
    array a = pieces::row(static_cast<unsigned>(1 + d.up_to(3)));
    for (tactor_spec& t : a.tactors) {
        t.gain_db = d.one_in(2) ? 0.0 : d.from_to(-12.0, 0.0);
        t.max_dbfs = d.one_in(2) ? 0.0 : d.from_to(-9.0, 0.0);
        t.polarity = d.one_in(3) ? -1 : 1;
        t.threshold_dbfs = d.from_to(-50.0, -30.0);
        if (d.one_in(6))
            t.rise_s = d.from_to(0.001, 0.05);
    }
    return a;
}

inline render_options some_options(dice& d)
{
    render_options o{.rate = d.one_in(2) ? 48000U : static_cast<unsigned>(8000 + d.up_to(92000))};
    o.together = together_kind::sum;
    o.level_dbfs = d.one_in(3) ? 0.0 : d.from_to(-20.0, 0.0);
    if (d.one_in(5))
        o.sl_db = d.from_to(0.0, 35.0);
    o.phase = d.pick({phase_kind::stroke, phase_kind::burst});
    if (!d.one_in(3))
        o.ramp_s = d.one_in(2) ? 0.0 : d.from_to(0.0, 0.01);
    o.envelope.kind = d.pick({envelope_kind::raised_cosine, envelope_kind::raised_cosine,
                              envelope_kind::linear, envelope_kind::exponential, envelope_kind::tukey});
    if (d.one_in(5))
        o.envelope.attack_s = d.from_to(0.0, 0.02);
    if (d.one_in(5))
        o.envelope.release_s = d.from_to(0.0, 0.02);
    o.envelope.tukey_part = d.from_to(0.0, 1.0);
    if (d.one_in(3))
        o.limits = drive_limits{};
    return o;
}

/// Draws a duration from a frame to 0.2 s, short and long equally often; every second one in whole frames.
inline double some_length(dice& d, unsigned rate)
{
    const double frames = d.one_in(5) ? 1.0 : std::exp(d.from_to(0.0, std::log(0.2 * rate)));
    return (d.one_in(2) ? std::max(1.0, std::round(frames)) : frames) / rate;
}

inline plan some_bursts(dice& d, unsigned tactors, unsigned rate)
{
    std::vector<burst> all;
    const int count = 1 + d.up_to(9);
    double end_s = 0.0;
    for (int i = 0; i < count; ++i) {
        const double length_s = some_length(d, rate);
        // After the one before it, a frame or less into it, or anywhere.
        const double back_s = d.pick({0.0, 1e-12, 1e-9, 0.5, 1.0, 1.5}) / rate;
        const double onset_s = d.one_in(2)   ? std::max(0.0, end_s - back_s)
                               : d.one_in(2) ? 0.0
                                             : d.from_to(0.0, 0.2);
        std::vector<drive> drives;
        for (unsigned t = 0; t < tactors; ++t)
            if (d.one_in(2))
                drives.push_back({t, d.one_in(3) ? 1.0 : d.from_to(0.0, 1.0)});
        if (!drives.empty() && d.one_in(20))
            drives.push_back(drives.front());
        all.push_back(pieces::make_burst(onset_s, length_s, std::move(drives), d.from_to(0.3, 1.0)));
        end_s = onset_s + length_s;
    }
    plan p = pieces::make_plan(std::move(all));
    p.overlap = d.pick({overlap_kind::energy, overlap_kind::max, overlap_kind::sum});
    return p;
}

inline plan some_curve(dice& d, unsigned tactors, unsigned rate)
{
    const double length_s = std::max(some_length(d, rate), 1e-4);
    curve_samples all;
    const std::uint64_t count = detail::count_samples(length_s);
    for (std::uint64_t k = 0; k < count; ++k) {
        burst b;
        for (unsigned t = 0; t < tactors; ++t)
            if (d.one_in(2))
                b.drives.push_back({t, d.from_to(0.0, 1.0)});
        all.add(b);
    }
    plan p;
    p.total_s = p.stroke_duration_s = length_s;
    p.curve = curve(length_s, std::move(all));
    return p;
}

/// Makes the mix of a number.
inline mix some_mix(std::uint64_t number)
{
    dice d(number);
    mix m{some_array(d), {}, some_options(d)};
    const auto tactors = static_cast<unsigned>(m.tactors.tactors.size());
    const int count = 1 + d.up_to(2);
    for (int i = 0; i < count; ++i) {
        plan p =
            d.one_in(4) ? some_curve(d, tactors, m.options.rate) : some_bursts(d, tactors, m.options.rate);
        p.carrier_hz = d.one_in(3) ? 250.0 : d.from_to(1.0, 0.499 * m.options.rate - 100.0);
        p.wave.kind = d.pick({waveform_kind::sine, waveform_kind::sine, waveform_kind::square,
                              waveform_kind::triangle, waveform_kind::sawtooth, waveform_kind::noise});
        if (d.one_in(4))
            p.am = {d.from_to(1.0, 100.0), d.from_to(0.0, 1.0)};
        std::optional<double> start_s;
        if (!d.one_in(4))
            start_s = d.one_in(2) ? 0.0 : d.from_to(0.0, 0.1);
        m.plans.push_back({std::move(p), start_s, {}});
    }
    return m;
}

} // namespace mixes
