// SPDX-License-Identifier: MIT
// Mixes against the record of their plans (tactor-json(5), FROM A PLAN TO SAMPLES): no sample is above it,
// however short the bursts are.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "mixes.hpp"
#include "rounds.hpp"
#include "synth/guard/guard.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"

namespace mixes_test {

using namespace tactor;
using mixes::mix;

namespace {

std::uint64_t to_frame(double t_s, unsigned rate)
{
    return static_cast<std::uint64_t>(std::floor(t_s * rate + 0.5 + 1e-6));
}

/// Per frame, by tactor: the channel's level by the record, without windows and carriers.
using levels = std::vector<std::vector<double>>;

struct part {
    double from_s;
    double to_s;
    std::uint64_t first;
    std::uint64_t end;
    double amplitude;
    double most; ///< of overlapping ones, with energy
};

double together(const std::vector<part>& group, std::uint64_t n, overlap_kind rule)
{
    double energy = 0.0;
    double sum = 0.0;
    double largest = 0.0;
    double most = 0.0;
    for (const part& p : group) {
        if (n < p.first || n >= p.end)
            continue;
        energy += p.amplitude * p.amplitude;
        sum += p.amplitude;
        largest = std::max(largest, p.amplitude);
        most = std::max(most, p.most);
    }
    return rule == overlap_kind::sum   ? sum
           : rule == overlap_kind::max ? largest
                                       : std::min(most, std::sqrt(energy));
}

void add_group(const std::vector<part>& group, overlap_kind rule, double peak, std::uint64_t start,
               std::vector<double>& out)
{
    std::uint64_t end = 0;
    for (const part& p : group)
        end = std::max(end, p.end);
    for (std::uint64_t n = group.empty() ? end : group.front().first; n < end; ++n)
        out[start + n] += peak * together(group, n, rule);
}

void add_bursts(const plan& p, unsigned rate, const std::vector<double>& peaks, std::uint64_t start,
                levels& out)
{
    std::map<unsigned, std::vector<part>> by_tactor;
    for (const burst& b : p.bursts) {
        double energy = 0.0;
        for (const drive& d : b.drives)
            energy += d.amplitude * d.amplitude;
        const double to_s = b.onset_s + b.duration_s;
        const part base{b.onset_s,
                        to_s,
                        to_frame(b.onset_s, rate),
                        to_frame(to_s, rate),
                        0.0,
                        std::max(b.intensity, std::sqrt(energy))};
        for (const drive& d : b.drives) {
            part one = base;
            one.amplitude = d.amplitude;
            if (one.end > one.first)
                by_tactor[d.tactor].push_back(one);
        }
    }
    for (auto& [tactor, parts] : by_tactor) {
        std::stable_sort(parts.begin(), parts.end(),
                         [](const part& a, const part& b) { return a.first < b.first; });
        std::vector<part> group;
        std::uint64_t end = 0;
        double end_s = 0.0;
        for (const part& one : parts) {
            if (one.first >= end || one.from_s >= end_s - 1e-9) {
                add_group(group, p.overlap, peaks[tactor], start, out[tactor]);
                group.clear();
                end = 0;
                end_s = 0.0;
            }
            group.push_back(one);
            end = std::max(end, one.end);
            end_s = std::max(end_s, one.to_s);
        }
        add_group(group, p.overlap, peaks[tactor], start, out[tactor]);
    }
}

void add_curve(const plan& p, unsigned rate, const std::vector<double>& peaks, std::uint64_t start,
               levels& out)
{
    const std::uint64_t length = to_frame(p.stroke_duration_s, rate);
    const auto at = [&](std::uint64_t k) {
        burst b;
        p.curve->sample(k, b);
        std::vector<double> amplitudes(out.size(), 0.0);
        for (const drive& d : b.drives)
            amplitudes[d.tactor] = d.amplitude;
        return amplitudes;
    };
    std::vector<double> before = at(0);
    std::uint64_t from = 0;
    for (std::uint64_t k = 1; from < length; ++k) {
        const std::vector<double> next = at(k);
        const std::uint64_t to = std::min(length, to_frame(static_cast<double>(k) * continuous_step_s, rate));
        for (std::size_t t = 0; t < out.size(); ++t) {
            for (std::uint64_t n = from; n < to; ++n) {
                const double part = static_cast<double>(n - from) / static_cast<double>(to - from);
                out[t][start + n] += peaks[t] * (before[t] + (next[t] - before[t]) * part);
            }
        }
        before = next;
        from = to;
    }
}

levels read_record(const mix& m, const score& s)
{
    std::vector<double> peaks;
    for (const tactor_spec& t : m.tactors.tactors) {
        const double db =
            m.options.sl_db ? *t.threshold_dbfs + *m.options.sl_db : m.options.level_dbfs + t.gain_db;
        peaks.push_back(std::pow(10.0, db / 20.0));
    }
    levels all(peaks.size(), std::vector<double>(s.frames(), 0.0));
    for (std::size_t i = 0; i < m.plans.size(); ++i) {
        const plan& p = m.plans[i].plan;
        if (p.curve)
            add_curve(p, m.options.rate, peaks, s.starts()[i], all);
        else
            add_bursts(p, m.options.rate, peaks, s.starts()[i], all);
    }
    return all;
}

/// Mixes a score with no limit except the guards.
std::vector<float> mix_samples(const score& s, const render_options& o)
{
    const std::vector<double> limits(s.channels(), 1.0);
    std::vector<synth::drive_event> events;
    synth::event_source source(s);
    for (; source.peek() != nullptr; source.pop())
        events.push_back(*source.peek());
    synth::mixer mixer(limits, format_kind::float32, events.size(),
                       o.limits ? synth::make_guards(*o.limits, s.rate()) : synth::guard_settings{});
    for (const synth::drive_event& e : events)
        REQUIRE(mixer.add(e));
    std::vector<float> samples(s.frames() * s.channels());
    mixer.process(s.frames(), reinterpret_cast<std::byte*>(samples.data()));
    CHECK(mixer.limited() == 0);
    return samples;
}

/// Returns by which part the samples are above the record; below 0: nowhere.
double excess(const std::vector<float>& samples, const levels& told)
{
    double most = -1.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        // Samples are floats: the nearest one may be half a step above.
        const auto level = static_cast<double>(static_cast<float>(told[i % told.size()][i / told.size()]));
        const double sample = std::abs(static_cast<double>(samples[i]));
        if (sample > 0.0)
            most = std::max(most, sample / level - 1.0);
    }
    return most;
}

} // namespace

TEST_CASE("no sample of random mixes is above the record, nor above the tactor's limit")
{
    int rendered = 0;
    int refused = 0;
    double most = -1.0;
    const int all = tactor::test::rounds(400, 10'000);
    for (int n = 0; n < all; ++n) {
        CAPTURE(n);
        const mix m = mixes::some_mix(static_cast<std::uint64_t>(n));
        std::optional<score> s;
        try {
            s.emplace(m.tactors, m.plans, m.options);
        } catch (const error& e) {
            const std::string why = e.what();
            CAPTURE(why);
            // Too loud, or, in one mix of 10,000, a modulation near its carrier.
            REQUIRE((why.find("would be driven at") != why.npos || why.find("hardly moves") != why.npos));
            ++refused;
            continue;
        }
        ++rendered;
        const std::vector<float> samples = mix_samples(*s, m.options);
        levels told = read_record(m, *s);
        for (std::size_t t = 0; t < told.size(); ++t) {
            const double limit = synth::tactor_limit(m.tactors, t);
            // A slow actuator gets more at first, as far as its limit allows.
            const bool rises = m.tactors.tactors[t].rise_s.has_value();
            for (double& level : told[t])
                level = rises ? limit : std::min(level, limit);
        }
        const double above = excess(samples, told);
        CHECK(above <= 0.0);
        most = std::max(most, above);
    }
    MESSAGE(rendered << " mixes rendered, " << refused << " refused, largest excess " << most);
    CHECK(rendered > all / 4);
    CHECK(refused > all / 10);
}

} // namespace mixes_test
