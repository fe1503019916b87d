// SPDX-License-Identifier: MIT
// Bursts and mixes against formulas written out, and peaks of continuous strokes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>
#include <tactor/render.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "mixes.hpp"
#include "own_curve.hpp"
#include "pieces.hpp"
#include "plan/curve_impl.hpp"
#include "rounds.hpp"
#include "synth/limits/guard.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"

namespace mixes_test {

using namespace tactor;
using mixes::mix;
using namespace pieces;

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
    CHECK(mixer.counts().limited == 0);
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

struct example {
    double onset_s;
    double duration_s;
    double amplitude;
    double carrier_hz;
    unsigned rate;
    double level_dbfs;
    std::optional<double> ramp_s;
    phase_kind phase;
};

std::vector<double> formula(const example& e, std::size_t frames)
{
    const auto n0 = static_cast<std::int64_t>(std::floor(e.onset_s * e.rate + 0.5));
    const auto n = static_cast<std::int64_t>(std::floor((e.onset_s + e.duration_s) * e.rate + 0.5)) - n0;
    const double begin_s = e.phase == phase_kind::burst ? 0.0 : e.onset_s;
    const auto crosses_zero = [&](double t) {
        const double half_cycles = 2.0 * t * e.carrier_hz;
        return std::abs(half_cycles - std::round(half_cycles)) <= 0.01;
    };
    const bool smooth = crosses_zero(begin_s) && crosses_zero(begin_s + e.duration_s) &&
                        2.0 * e.duration_s * e.carrier_hz > 0.5;
    const double ramp_s = e.ramp_s ? *e.ramp_s : (smooth ? 0.0 : 0.002);
    const auto r =
        std::min<std::int64_t>(static_cast<std::int64_t>(std::floor(ramp_s * e.rate + 0.5)), n / 2);
    const double level = std::pow(10.0, e.level_dbfs / 20.0);
    std::vector<double> x(frames, 0.0);
    for (std::int64_t k = 0; k < n; ++k) {
        const auto carrier = static_cast<double>(e.phase == phase_kind::burst ? k : n0 + k);
        x[static_cast<std::size_t>(n0 + k)] =
            level * e.amplitude * window(k, n, r) * sine(e.carrier_hz, carrier, e.rate);
    }
    return x;
}

score make_score(const example& e)
{
    return {row(2),
            {{make_plan({make_burst(e.onset_s, e.duration_s, {{1, e.amplitude}})}, e.carrier_hz), {}}},
            {.rate = e.rate, .phase = e.phase, .ramp_s = e.ramp_s, .level_dbfs = e.level_dbfs}};
}

std::vector<example> examples()
{
    std::vector<example> all{
        {0.0, 0.07, 1.0, 250.0, 48000, -12.0, {}, phase_kind::burst},
        {0.14, 0.07, 0.7, 250.0, 44100, 0.0, {}, phase_kind::stroke},
        {0.01, 0.0413, 0.9, 250.0, 48000, -3.0, {}, phase_kind::burst},
        {0.01, 0.0001, 0.9, 3000.0, 8000, -3.0, {}, phase_kind::burst},
    };
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < tactor::test::rounds(300); ++i) {
        const unsigned rates[] = {8000, 22050, 44100, 48000, 96000, 192000};
        example e{};
        e.onset_s = 0.3 * unit(random);
        e.duration_s = 0.15 * unit(random);
        e.amplitude = unit(random);
        e.carrier_hz = 20.0 + 900.0 * unit(random);
        e.rate = rates[random() % 6];
        e.level_dbfs = -30.0 * unit(random);
        e.phase = random() % 2 == 0 ? phase_kind::burst : phase_kind::stroke;
        if (random() % 2 == 0)
            e.ramp_s = 0.02 * unit(random) * static_cast<double>(random() % 3);
        all.push_back(e);
    }
    return all;
}

const array palm = preset_array("palm-3x3");

/// \param level_db takes it above intensity 1
plan continuous(std::vector<timed_point> points, double level_db, plan_options o = {})
{
    o.algorithm = algorithm_kind::continuous;
    return detail::scale_plan(make_plan(palm, {.motion = trajectory::timed(std::move(points))}, o),
                              std::pow(10.0, level_db / 20.0));
}

/// Hides everything of a plan except its values.
plan opaque(plan p)
{
    p.curve = test::make_curve(p.stroke_duration_s, [c = *p.curve](double t, burst& out) { c.at(t, out); });
    return p;
}

std::string refusal(const std::vector<placed_plan>& plans, double level_dbfs)
{
    return caught_message(
        [&] { score(palm, plans, {.level_dbfs = level_dbfs, .together = together_kind::sum}); });
}

/// Makes intensity 0.0005 over the array, except for 8 ms round a time.
std::vector<timed_point> with_spike(double duration_s, double at_s, double intensity)
{
    const auto place = [&](double t) { return point{40.0 * t / duration_s, 20.0}; };
    std::vector<timed_point> points{{0.0, place(0.0), 0.0005}};
    for (const auto& [off, i] : {std::pair{-0.004, 0.0005}, {0.0, intensity}, {0.004, 0.0005}})
        points.push_back({at_s + off, place(at_s + off), i});
    points.push_back({duration_s, place(duration_s), 0.0005});
    return points;
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
            REQUIRE((why.find("would play at") != why.npos || why.find("a slow displacement") != why.npos));
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

TEST_CASE("a burst is the formula to one float ulp")
{
    for (const example& e : examples()) {
        const score s = make_score(e);
        const auto x = formula(e, s.frames());
        const auto bytes = render(s, format_kind::float32);
        std::size_t wrong = 0;
        for (std::size_t k = 0; k < x.size(); ++k) {
            const float got = sample<float>(bytes, 2 * k + 1);
            const auto exact = static_cast<float>(x[k]);
            const double ulp = static_cast<double>(std::nextafter(std::abs(exact), 2.0F) - std::abs(exact));
            wrong += std::abs(static_cast<double>(got) - x[k]) <= std::max(ulp, 1e-12) ? 0 : 1;
            wrong += sample<float>(bytes, 2 * k) == 0.0F ? 0 : 1;
        }
        CAPTURE(e.onset_s);
        CAPTURE(e.rate);
        CHECK(wrong == 0);
    }
}

TEST_CASE("bursts that touch after rounding share no frame")
{
    // 0.07 s at 22050 Hz is 1543.5 frames: every other boundary is a tie.
    std::vector<burst> bursts;
    for (int k = 0; k < 40; ++k)
        bursts.push_back(make_burst(k * 0.07, 0.07, {{0, 1.0}}));
    render_options o{.rate = 22050, .level_dbfs = 0.0};
    const auto whole = channel(score(row(1), {{make_plan(bursts), {}}}, o), 0);
    for (std::size_t k = 0; k < whole.size(); ++k)
        REQUIRE(std::abs(whole[k] - sine(250.0, k, 22050.0)) < 1e-6);
    o.phase = phase_kind::burst;
    const auto x = channel(score(row(1), {{make_plan(bursts), {}}}, o), 0);
    for (int k = 0; k < 40; ++k) {
        const auto n0 = static_cast<std::size_t>(std::floor(k * 1543.5 + 0.5));
        CHECK(std::abs(x[n0]) < 1e-9);
        CHECK(x[n0 + 1] == doctest::Approx(sine(250.0, 1, 22050.0)));
    }
}

TEST_CASE("a spike of 8 ms is found in strokes of ten seconds to an hour, and accepted where it does no harm")
{
    std::mt19937_64 random(11);
    for (const double duration : {10.0, 1048.0, 1049.0, 3600.0}) {
        for (int n = 0; n < (duration > 100.0 ? 2 : 20); ++n) {
            std::uniform_int_distribution<int> ms(5, static_cast<int>(duration * 1000.0) - 5);
            const double at = ms(random) * 0.001;
            CAPTURE(duration);
            CAPTURE(at);
            const plan p = continuous(with_spike(duration, at, 1.0), 60.0);
            has(refusal({{p, {}}}, -40.0), "dBFS, above full scale");
            CHECK(refusal({{p, {}}}, -60.0).empty());
        }
    }
    // On a tactor that one gets the whole amplitude, and the message has the value.
    const plan p = continuous(with_spike(3600.0, 1800.0, 1.0), 60.0);
    has(refusal({{p, {}}}, -40.0), "tactor 4: it would play at 20 dBFS, above full scale");
}

TEST_CASE("a plan is left unseen only where its intensity is above no limit: as if every point was looked at")
{
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double stronger_db = 20.0 * std::log10(1.7);
    int refused = 0;
    for (int n = 0; n < 120; ++n) {
        CAPTURE(n);
        std::vector<timed_point> points;
        for (double t = 0.0; t < 1.0 + unit(random); t += 1e-4 + 0.2 * std::pow(unit(random), 3.0))
            points.push_back({t, {40.0 * unit(random), 40.0 * unit(random)}, unit(random)});
        points.push_back({2.5, {20.0, 20.0}, 0.0});
        plan_options o{.phantom = static_cast<phantom_kind>(n % 5)};
        plan p = continuous(points, stronger_db, o);
        if (n % 3 == 0) {
            const stroke s{.motion = trajectory::timed(points).with_duration(0.7).with_intensity(0.9)};
            o.algorithm = algorithm_kind::continuous;
            p = detail::scale_plan(make_plan(palm, s, o), 1.7);
        }
        const double level = -6.0 * unit(random);
        const std::string said = refusal({{p, {}}}, level);
        CHECK(said == refusal({{opaque(p), {}}}, level));
        refused += said.empty() ? 0 : 1;
    }
    CHECK(refused > 20);
    CHECK(refused < 100);
}

TEST_CASE("a stroke with a spike that no tactor alone could have is played where two share it")
{
    // On a diagonal; harmless before and after.
    const plan p = continuous({{0.0, {0.0, 10.0}, 0.25},
                               {5.0, {10.0, 10.0}, 0.25},
                               {5.1, {10.0, 10.0}, 0.65},
                               {5.2, {10.0, 10.0}, 0.25},
                               {10.0, {40.0, 10.0}, 0.25}},
                              20.0 * std::log10(2.0));
    CHECK(refusal({{p, {}}}, 0.0).empty());
    const std::vector<double> peaks = synth::continuous_peaks(p, 9);
    CHECK(peaks[0] == doctest::Approx(1.3 / std::sqrt(2.0)));
    CHECK(peaks[8] == 0.0);
    CHECK(synth::continuous_bounds(p, 9) == std::vector<double>(9, 1.3));
}

TEST_CASE("a plan for a larger array is looked at, and refused where it drives a tactor that is not there")
{
    const array wide = make_grid("wide", 3, 4, 20.0, 20.0);
    plan_options o{.algorithm = algorithm_kind::continuous};
    const auto down = [&](double to_mm) {
        return make_plan(wide, {"", trajectory::timed({{0.0, {1.0, 1.0}}, {10.0, {1.0, to_mm}}})}, o);
    };
    CHECK(synth::continuous_bounds(down(9.0), 9).empty());
    CHECK(refusal({{down(9.0), {}}}, -12.0).empty());
    has(refusal({{down(39.0), {}}}, -12.0), "cannot be rendered");
}

TEST_CASE("every control point of a program's plan is evaluated")
{
    std::uint64_t looks = 0;
    double spike_s = 0.0;
    plan p;
    p.total_s = p.stroke_duration_s = 1500.0;
    p.curve = test::make_curve(1500.0, [&](double t, burst& out) {
        ++looks;
        out.drives = {{3, std::abs(t - spike_s) < 0.0005 ? 1000.0 : 0.5}};
    });
    spike_s = -1.0;
    CHECK(refusal({{p, {}}}, -40.0).empty());
    CHECK(looks >= 1'500'001);
    for (const double at : {0.0, 0.001, 1048.577, 1499.999, 1500.0}) {
        CAPTURE(at);
        spike_s = at;
        has(refusal({{p, {}}}, -40.0), "tactor 3: it would play at 20 dBFS");
    }
}

TEST_CASE("strokes that are harmless alone are added up where they overlap, even after hours")
{
    for (const double rest : {1.0, 5000.0}) {
        CAPTURE(rest);
        // Silent for long, then a second on the middle tactor.
        const plan late = continuous({{0.0, {20.0, 20.0}, 0.0},
                                      {rest, {20.0, 20.0}, 0.0},
                                      {rest + 0.5, {20.0, 20.0}, 0.7},
                                      {rest + 1.0, {20.0, 20.0}, 0.0}},
                                     0.0);
        const auto with = [&](double amplitude, double at) {
            plan p = pieces::make_plan({pieces::make_burst(0.0, 0.07, {{4, amplitude}})});
            return refusal({{late, 0.0}, {p, at}}, 0.0);
        };
        CHECK(with(0.29, rest).empty());
        has(with(0.31, rest), "tactor 4: it would play at 0.08");
        CHECK(has(with(0.31, 0.1), "tactor 4")); // both last on at once: taken together
        CHECK(with(0.99, rest + 1.0).empty());
    }
}

} // namespace mixes_test
