// SPDX-License-Identifier: MIT
// Waveforms, computed and recorded.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "caught.hpp"
#include "core/access.hpp"
#include "count_allocations.hpp"
#include "has.hpp"
#include "pieces.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/make_timbre.hpp"

namespace waveforms_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 48000;
constexpr std::size_t frames = 65536;
constexpr double line_hz = static_cast<double>(rate) / frames;

waveform shape(waveform_kind k)
{
    waveform w;
    w.kind = k;
    return w;
}

waveform noise(double low_hz, double high_hz, std::uint64_t seed = 1)
{
    waveform w = shape(waveform_kind::noise);
    w.low_hz = low_hz;
    w.high_hz = high_hz;
    w.seed = seed;
    return w;
}

waveform recorded(std::vector<float> samples, texture_kind texture, double rate_hz = 8000.0)
{
    waveform w = shape(waveform_kind::recording);
    w.recorded = std::make_shared<const recording>(recording{"x.wav", rate_hz, std::move(samples)});
    w.texture = texture;
    return w;
}

plan tone(const waveform& w, double hz, double duration_s = 1.5, double amplitude = 1.0)
{
    plan p = pieces::make_plan({make_burst(0.0, duration_s, {{0, amplitude}})}, hz);
    p.wave = w;
    return p;
}

std::vector<double> played(const plan& p, double level_dbfs = 0.0, unsigned at_rate = rate)
{
    return channel(score(row(1), p, {.rate = at_rate, .ramp_s = 0.0, .level_dbfs = level_dbfs}), 0);
}

/// Returns the amplitude of each line in the middle of a tone, in a window of Blackman and Harris (sidelobes:
/// -92 dB).
std::vector<double> lines(const std::vector<double>& x)
{
    REQUIRE(x.size() >= 2000 + frames);
    synth::spectrum s(frames);
    for (std::size_t n = 0; n < frames; ++n) {
        const double a = static_cast<double>(n) / frames;
        const double w = 0.35875 - 0.48829 * std::cos(2 * pi * a) + 0.14128 * std::cos(4 * pi * a) -
                         0.01168 * std::cos(6 * pi * a);
        s[n] = w * x[2000 + n] * (2.0 / (0.35875 * frames));
    }
    synth::compute_fourier_sum(s);
    std::vector<double> amplitudes(frames / 2);
    std::transform(s.begin(), s.begin() + frames / 2, amplitudes.begin(),
                   [](const std::complex<double>& v) { return std::abs(v); });
    return amplitudes;
}

/// Returns the amplitude of a sine at a frequency: the window spreads its power over lines, as 2.0044 of
/// them.
double strongest(const std::vector<double>& spectrum, double hz)
{
    const auto at = static_cast<std::ptrdiff_t>(std::lround(hz / line_hz));
    double power = 0.0;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(at - 5, 0); i <= at + 5; ++i)
        power += spectrum[static_cast<std::size_t>(i)] * spectrum[static_cast<std::size_t>(i)] / 2.0044;
    return std::sqrt(power);
}

/// Returns the strongest line farther than 8 from every multiple of `hz`, in dB below the strongest of all.
double stray_db(const std::vector<double>& spectrum, double hz, double offset_hz = 0.0)
{
    double stray = 0.0;
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
        const double turns = (static_cast<double>(i) * line_hz - offset_hz) / hz;
        if (std::abs(turns - std::round(turns)) * hz > 8.0 * line_hz)
            stray = std::max(stray, spectrum[i]);
    }
    return 20.0 * std::log10(stray / *std::max_element(spectrum.begin(), spectrum.end()));
}

double greatest(const std::vector<double>& x)
{
    return std::abs(
        *std::max_element(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
}

constexpr waveform_kind shapes[] = {waveform_kind::square, waveform_kind::triangle, waveform_kind::sawtooth};

std::vector<float> make_sine(std::size_t samples, double cycles, double amplitude, double offset = 0.0)
{
    std::vector<float> x(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        const double turns = cycles * static_cast<double>(i) / static_cast<double>(samples);
        x[i] = static_cast<float>(offset + amplitude * std::sin(2 * pi * turns));
    }
    return x;
}

/// Returns how far a timbre's phase is from `cycles` at a frame, in cycles.
double off_phase(const synth::timbre& t, std::int64_t frame, double cycles)
{
    double x = 0.0;
    double y = 0.0;
    t.fill(frame, 0, 1, &x, synth::wave::sine);
    t.fill(frame, 0, 1, &y, synth::wave::cosine);
    const double off = std::atan2(x, y) / (2 * pi) - cycles;
    return std::abs(off - std::round(off));
}

std::string refusal(const waveform& w, double hz = 250.0)
{
    return caught_message([&] { return played(tone(w, hz, 0.1)); });
}

} // namespace

TEST_CASE("no harmonic folds back at half the rate: aliases are at least 80 dB down")
{
    // None divides the rate: an alias would lie between the harmonics.
    for (const waveform_kind k : shapes) {
        for (const double hz : {20.3, 61.7, 250.7, 441.3, 997.1}) {
            CAPTURE(std::string(to_string(k)));
            CAPTURE(hz);
            CHECK(stray_db(lines(played(tone(shape(k), hz))), hz) < -80.0);
        }
    }
}

TEST_CASE("the harmonics below half the rate are those of the shape")
{
    for (const double hz : {100.1, 250.7, 997.1}) {
        for (const waveform_kind k : shapes) {
            const auto x = lines(played(tone(shape(k), hz)));
            const double first = strongest(x, hz);
            for (int h = 2; h * hz < 0.5 * rate - 10.0; ++h) {
                CAPTURE(std::string(to_string(k)));
                CAPTURE(h);
                const bool there = k == waveform_kind::sawtooth || h % 2 == 1;
                const double expected = !there ? 0.0 : k == waveform_kind::triangle ? 1.0 / h / h : 1.0 / h;
                REQUIRE(std::abs(strongest(x, h * hz) / first - expected) < 3e-4 + 0.03 * expected);
            }
        }
    }
}

TEST_CASE("a wave's peak is the given amplitude")
{
    std::vector<float> samples{0.0F, 0.1F, 0.3F, -0.2F, 0.05F, -0.1F, 0.2F};
    std::vector<waveform> all{noise(50, 500), noise(100, 110), recorded(samples, texture_kind::cycle),
                              recorded(samples, texture_kind::time)};
    for (const waveform_kind k : shapes)
        all.push_back(shape(k));
    for (const waveform& w : all) {
        CAPTURE(waveform_text(w));
        const double peak = greatest(played(tone(w, 100.0, 6.0), -6.0));
        const double asked = std::pow(10.0, -6.0 / 20.0);
        CHECK(peak <= asked * (1.0 + 1e-6));
        CHECK(peak >= asked * 0.97);
    }
}

TEST_CASE("noise lies between its frequencies and depends on its seed")
{
    const auto x = lines(played(tone(noise(100, 300), 250.0)));
    const double most = *std::max_element(x.begin(), x.end());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double hz = static_cast<double>(i) * line_hz;
        if (hz < 100.0 - 8.0 * line_hz || hz > 300.0 + 8.0 * line_hz)
            REQUIRE(x[i] < 1e-4 * most);
    }
    CHECK(played(tone(noise(100, 300, 1), 250.0)) == played(tone(noise(100, 300, 1), 200.0)));
    CHECK(played(tone(noise(100, 300, 1), 250.0)) != played(tone(noise(100, 300, 2), 250.0)));
}

TEST_CASE("modulation has two sidebands and keeps the peak")
{
    plan p = tone(shape(waveform_kind::sine), 250.0);
    p.am = {30.0, 0.5};
    const auto raw = played(p);
    CHECK(greatest(raw) <= 1.0 + 1e-6);
    const auto x = lines(raw);
    const double carrier = strongest(x, 250.0);
    CHECK(carrier == doctest::Approx(1.0 / 1.5).epsilon(1e-3));
    CHECK(strongest(x, 220.0) / carrier == doctest::Approx(0.25).epsilon(1e-3));
    CHECK(strongest(x, 280.0) / carrier == doctest::Approx(0.25).epsilon(1e-3));
    for (std::size_t k = 0; k < 48000; k += 7) {
        const double t = static_cast<double>(k) / rate;
        const double exact = (1.0 + 0.5 * std::sin(2 * pi * 30.0 * t)) / 1.5 * std::sin(2 * pi * 250.0 * t);
        REQUIRE(std::abs(raw[k] - exact) < 1e-6);
    }
    // The sidebands of harmonics do not fold back either.
    plan q = tone(shape(waveform_kind::sawtooth), 997.1);
    q.am = {313.0, 1.0};
    const auto y = lines(played(q));
    double stray = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double hz = static_cast<double>(i) * line_hz;
        bool known = false;
        for (const double side : {-313.0, 0.0, 313.0}) {
            const double h = (hz - side) / 997.1;
            known = known || std::abs(h - std::round(h)) * 997.1 <= 8.0 * line_hz;
        }
        stray = known ? stray : std::max(stray, y[i]);
    }
    CHECK(stray < 1e-4 * *std::max_element(y.begin(), y.end()));
}

TEST_CASE("block sizes make no difference to any wave")
{
    std::mt19937_64 random(5);
    std::vector<waveform> all{noise(50, 500), recorded({0.0F, 1.0F, -1.0F, 0.5F}, texture_kind::cycle),
                              recorded({0.0F, 1.0F, -1.0F, 0.5F}, texture_kind::time),
                              shape(waveform_kind::sine)};
    for (const waveform_kind k : shapes)
        all.push_back(shape(k));
    for (const waveform& w : all) {
        plan p = make_random(random, 3, 20, 0.3);
        p.wave = w;
        p.am = {37.0, 0.7};
        p.course = {{0.0, 80.0}, {0.1, 300.0}, {0.1, 120.0}, {0.25, 240.0}};
        render_options o{.level_dbfs = -30.0};
        o.limits.emplace();
        const score s(row(3), p, o);
        const auto whole = render(s, format_kind::float32);
        CHECK(whole == render(
                           s, format_kind::float32, [&] { return 1 + random() % 700; }, s.frames()));
    }
}

TEST_CASE("a phase that restarts with each burst leaves the stroke's course, modulation and texture alone")
{
    // Three bursts on one tactor, and two that are joined, of a stroke that begins late.
    plan p = pieces::make_plan({make_burst(0.0, 0.07, {{0, 1.0}}), make_burst(0.101, 0.07, {{0, 1.0}}),
                                make_burst(0.203, 0.07, {{0, 1.0}}), make_burst(0.31, 0.07, {{0, 1.0}}),
                                make_burst(0.35, 0.07, {{0, 1.0}})});
    p.overlap = overlap_kind::max;
    const auto frames = [](double s) { return static_cast<std::size_t>(std::lround(s * rate)); };
    const std::vector<std::pair<std::size_t, std::size_t>> pieces_at{{0, frames(0.07)},
                                                                     {frames(0.101), frames(0.171)},
                                                                     {frames(0.203), frames(0.273)},
                                                                     {frames(0.31), frames(0.42)}};
    render_options o{.ramp_s = 0.0, .level_dbfs = 0.0};
    const auto played_with = [&](phase_kind k) {
        o.phase = k;
        std::vector<double> x = channel(score(row(1), std::vector<placed_plan>{{p, 0.5}}, o), 0);
        x.erase(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(frames(0.5)));
        return x;
    };
    SUBCASE("a sine with a course and a modulation")
    {
        p.course = {{0.0, 80.0}, {0.2, 300.0}, {0.42, 200.0}};
        p.am = {5.0, 0.7};
        const auto cycles = [](double t) {
            return t < 0.2 ? 80.0 * t + 0.5 * 1100.0 * t * t
                           : 38.0 + 300.0 * (t - 0.2) - 0.5 * (100.0 / 0.22) * (t - 0.2) * (t - 0.2);
        };
        const auto x = played_with(phase_kind::burst);
        double worst = 0.0;
        for (const auto& [from, to] : pieces_at) {
            for (std::size_t n = from; n < to; ++n) {
                const double t = static_cast<double>(n) / rate;
                const double turned = cycles(t) - cycles(static_cast<double>(from) / rate);
                const double am = (1.0 + 0.7 * std::sin(2.0 * pi * 5.0 * t)) / 1.7;
                worst = std::max(worst, std::abs(x[n] - am * std::sin(2.0 * pi * turned)));
            }
        }
        CHECK(worst < 1e-6);
    }
    SUBCASE("noise, and a recording by time, which have no phase")
    {
        p.wave = noise(50, 500);
        CHECK(played_with(phase_kind::burst) == played_with(phase_kind::stroke));
        p.wave = recorded({0.0F, 1.0F, -1.0F, 0.5F}, texture_kind::time);
        CHECK(played_with(phase_kind::burst) == played_with(phase_kind::stroke));
    }
    SUBCASE("a shape begins with each burst")
    {
        p.wave = shape(waveform_kind::square);
        const auto x = played_with(phase_kind::burst);
        for (const auto& [from, to] : pieces_at)
            for (std::size_t n = 0; n < frames(0.07); ++n)
                CHECK(std::abs(x[from + n] - x[n]) < 1e-6);
    }
}

TEST_CASE("the limit on the power counts the real power of a wave")
{
    constexpr double three = 2.9999999999;
    for (const waveform_kind k : {waveform_kind::square, waveform_kind::sawtooth, waveform_kind::sine}) {
        plan p = pieces::make_plan({make_burst(0.0, 1.0, {{0, 1.0}, {1, 1.0}, {2, 1.0}})}, 250.0);
        p.wave = shape(k);
        render_options o{.level_dbfs = 0.0};
        o.limits.emplace();
        const score s(row(3), p, o);
        const auto bytes = render(s, format_kind::float32);
        double sum = 0.0; // twice the mean square: a sine at full scale has 1
        for (std::size_t i = 24000; i < 33600; ++i) {
            for (unsigned c = 0; c < 3; ++c) {
                const auto x = static_cast<double>(sample<float>(bytes, 3 * i + c));
                sum += 2.0 * x * x / 9600.0;
            }
        }
        CAPTURE(std::string(to_string(k)));
        CHECK(sum <= three * (1.0 + 1e-3));
        // Neither loses more than it must.
        CHECK(sum > (k == waveform_kind::sawtooth ? 1.4 : 2.9));
    }
}

COUNTING_TEST_CASE("waves are played without allocating")
{
    plan p = make_continuous(9, 0.8);
    p.course = {{0.0, 80.0}, {0.5, 300.0}};
    p.am = {20.0, 1.0};
    std::vector<placed_plan> plans;
    for (const waveform& w : {shape(waveform_kind::square), noise(20, 900), shape(waveform_kind::sine)}) {
        p.wave = w;
        plans.push_back({p, 0.0});
    }
    render_options o{.level_dbfs = -20.0};
    o.limits.emplace();
    const score s(row(9), plans, o);
    renderer r(s, format_kind::float32);
    std::vector<std::byte> out(500 * s.channels() * 4);
    const test::count_allocations count;
    while (r.position() < s.frames())
        r.process(out);
    CHECK(count.calls() == 0);
}

TEST_CASE("the phase of a carrier that changes is its integral, to 1e-9 cycles after an hour")
{
    // 100 to 300 Hz in the first 20 minutes, back to 150 Hz in the rest.
    plan p = tone(shape(waveform_kind::sine), 250.0, 3600.0);
    p.course = {{0.0, 100.0}, {1200.0, 300.0}, {3600.0, 150.0}};
    const score s(row(1), p, {.ramp_s = 0.0, .level_dbfs = 0.0});
    const synth::timbre& t = *detail::access::of(s).sounds.front();
    double worst = 0.0;
    for (std::int64_t k = 0; k < std::int64_t{3600} * rate; k += 7919 * 61) {
        const long double at = static_cast<long double>(k) / rate;
        const long double cycles = at <= 1200.0L ? 100.0L * at + at * at * (200.0L / 2400.0L)
                                                 : 240000.0L + 300.0L * (at - 1200.0L) -
                                                       (at - 1200.0L) * (at - 1200.0L) * (150.0L / 4800.0L);
        worst = std::max(worst, off_phase(t, k, static_cast<double>(cycles - std::floor(cycles))));
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("the phase of a carrier whose frequency is bent is its integral, and goes on behind the bend")
{
    const std::array<double, 4> bend{120.0, -340.0, 90.0, 260.0};
    plan p = tone(shape(waveform_kind::sine), 250.0, 1.0);
    p.course = {{0.0, 100.0, bend}, {0.4, 300.0}, {1.0, 150.0}};
    const score s(row(1), p, {.ramp_s = 0.0, .level_dbfs = 0.0});
    const synth::timbre& t = *detail::access::of(s).sounds.front();
    const auto hz = [&](double at_s) {
        if (at_s >= 0.4)
            return 300.0 - 150.0 * (at_s - 0.4) / 0.6;
        const double u = at_s / 0.4;
        return 100.0 + 200.0 * u + u * (1.0 - u) * (bend[0] + u * (bend[1] + u * (bend[2] + u * bend[3])));
    };
    const double step = 1.0 / rate;
    double cycles = 0.0;
    double worst = 0.0;
    for (unsigned k = 0; k < rate; ++k) {
        worst = std::max(worst, off_phase(t, k, cycles));
        const double at_s = k * step;
        cycles += step / 6.0 * (hz(at_s) + 4.0 * hz(at_s + 0.5 * step) + hz(at_s + step)); // Simpson
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("a modulation at a harmonic that the wave has is refused: it would be a displacement")
{
    const auto refusal = [](const waveform& w, double am_hz, const std::vector<carrier_point>& course = {}) {
        plan p = tone(w, 250.0, 0.1);
        p.am = {am_hz, 1.0};
        p.course = course;
        return caught_message([&] { return played(p); });
    };
    const waveform sine = shape(waveform_kind::sine);
    for (const double hz : {245.0, 250.0, 255.0})
        has(refusal(sine, hz), "am: " + fmt::format("{}", hz) + " Hz is within 5 Hz of the carrier, 250 Hz");
    for (const double hz : {30.0, 244.9, 255.1, 500.0, 750.0})
        CHECK(refusal(sine, hz).empty());
    for (const waveform_kind k : shapes) {
        has(refusal(shape(k), 752.0), "harmonic 3 of the carrier, 750 Hz");
        CHECK(refusal(shape(k), 600.0).empty());
        CHECK(refusal(shape(k), 500.0).empty() == (k != waveform_kind::sawtooth));
    }
    const waveform twice = recorded({0.0F, 1.0F, 0.0F, -1.0F, 0.0F, 1.0F, 0.0F, -1.0F}, texture_kind::cycle);
    CHECK(refusal(twice, 250.0).empty());
    has(refusal(twice, 500.0), "harmonic 2");
    has(refusal(sine, 150.0, {{0.0, 100.0}, {0.1, 200.0}}), "the carrier passes 150 Hz on its way from 100");
    CHECK(refusal(sine, 94.0, {{0.0, 100.0}, {0.1, 200.0}}).empty());
    CHECK(refusal(noise(100, 300), 200.0).empty());
}

TEST_CASE("a course that no plan makes is refused, so that no file makes other than vibrations")
{
    using course = std::vector<carrier_point>;
    const double nan = std::nan("");
    const course sound{{0.0, 100.0, {20.0, 0.0, 0.0, 0.0}}, {0.05, 200.0}, {0.1, 150.0}};
    std::vector<course> bad(9, sound);
    bad[0][1].hz = nan;
    bad[1][1].t_s = nan;
    bad[2][0].bend[3] = nan;
    bad[3][2].t_s = 1e308;
    bad[4][0].t_s = -1e308;
    bad[5][2].t_s = 0.04;
    bad[6][0].hz = -1.0;
    bad[7][0].bend[0] = 1e6; // between the points it is above half the rate
    bad[8][2].hz = HUGE_VAL;
    for (const waveform_kind k : {waveform_kind::sine, waveform_kind::square, waveform_kind::triangle}) {
        plan p = tone(shape(k), 250.0, 0.1);
        p.course = sound;
        CHECK_NOTHROW(played(p));
        for (const course& c : bad) {
            p.course = c;
            has(caught_message([&] { played(p); }), "of its course cannot be rendered at a rate of 48000 Hz");
        }
    }
}

TEST_CASE("waves that cannot be rendered are refused with a hint")
{
    const auto refused = [](const waveform& w, const modulation& m, const std::string& part,
                            unsigned at_rate = rate) {
        plan p = tone(w, 250.0, 0.1);
        p.am = m;
        return has(caught_message([&] { return played(p, 0.0, at_rate); }), part);
    };
    CHECK(refused(noise(500, 100), {}, "noise from 500 to 100"));
    CHECK(refused(noise(0.0, 100), {}, "noise from 0 to 100"));
    CHECK(refused(noise(50, std::nan("")), {}, "noise from 50"));
    CHECK(refused(noise(50, 30000), {}, "half the rate"));
    CHECK(refused(noise(50, 3990), {200.0, 1.0}, "half the rate", 8000));
    CHECK(refused(shape(waveform_kind::sine), {-1.0, 1.0}, "is not a modulation frequency"));
    CHECK(refused(shape(waveform_kind::sine), {30.0, 1.5}, "not a depth"));
    CHECK(refused(shape(waveform_kind::sine), {3900.0, 1.0}, "half the rate", 8000));
    CHECK(refused(shape(waveform_kind::recording), {}, "no samples"));
    CHECK(refused(recorded({0.5F}, texture_kind::cycle), {}, "1 sample"));
    CHECK(refused(recorded({0.0F, std::nanf("")}, texture_kind::time), {}, "not a number"));
    std::vector<float> samples(4000000, 1.0F);
    samples[0] = 0.5F;
    CHECK(refused(recorded(samples, texture_kind::time, 100.0), {}, "too long"));
    samples.resize(70000);
    CHECK(refused(recorded(samples, texture_kind::length), {}, "too many"));
}

TEST_CASE("a recording is the carrier's cycle, without aliases")
{
    // 63 samples with every harmonic, some of them strong.
    std::vector<float> cycle;
    for (int i = 0; i < 63; ++i)
        cycle.push_back(static_cast<float>(i * i % 17) - 8.0F);
    for (const double hz : {250.7, 997.1}) {
        const auto x = lines(played(tone(recorded(cycle, texture_kind::cycle), hz)));
        CHECK(stray_db(x, hz) < -80.0);
        CHECK(x[0] < 1e-4 * *std::max_element(x.begin(), x.end())); // no constant
    }
}

TEST_CASE("a recording in time has its samples at its rate, and its frequencies at another")
{
    std::vector<float> samples(4801);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = 0.25F * static_cast<float>(std::sin(static_cast<double>(i * i) * 1e-4));
    const auto same = played(tone(recorded(samples, texture_kind::time, rate), 250.0, 0.1));
    double mean = 0.0;
    for (const float v : samples)
        mean += static_cast<double>(v) / static_cast<double>(samples.size());
    const double gain = same[700] / (static_cast<double>(samples[700]) - mean);
    for (std::size_t i = 0; i < same.size(); ++i)
        REQUIRE(std::abs(same[i] - gain * (static_cast<double>(samples[i]) - mean)) < 1e-6);
    // 300 Hz for a second at 8 kHz.
    std::vector<float> tone_samples(8000);
    for (std::size_t i = 0; i < tone_samples.size(); ++i)
        tone_samples[i] = static_cast<float>(std::sin(2 * pi * 300.0 * static_cast<double>(i) / 8000.0));
    const auto x = lines(played(tone(recorded(tone_samples, texture_kind::time), 250.0)));
    CHECK(strongest(x, 300.0) == doctest::Approx(1.0).epsilon(0.01));
    CHECK(stray_db(x, 1e9, 300.0) < -80.0);
}

TEST_CASE("a recording at another rate keeps its level up to 0.95 of its highest frequency")
{
    // Whole cycles in a second; the low one gives the scale.
    for (const double rate_hz : {8000.0, 11025.0, 44100.0})
        for (const double part : {0.5, 0.9, 0.95}) {
            const double high_hz = std::floor(0.5 * rate_hz * part);
            std::vector<float> both(static_cast<std::size_t>(rate_hz));
            for (std::size_t i = 0; i < both.size(); ++i) {
                const double t = 2 * pi * static_cast<double>(i) / rate_hz;
                both[i] = static_cast<float>(0.5 * std::sin(300.0 * t) + 0.5 * std::sin(high_hz * t));
            }
            const auto x = lines(played(tone(recorded(both, texture_kind::time, rate_hz), 250.0)));
            CAPTURE(rate_hz);
            CAPTURE(part);
            CHECK(std::abs(20.0 * std::log10(strongest(x, high_hz) / strongest(x, 300.0))) < 0.1);
        }
}

TEST_CASE("a recording along the path follows the target's speed")
{
    // A cycle of a sine over 10 mm of a path of 40 mm: 4 cycles, in 1 s and then in 4 s.
    std::vector<float> cycle;
    for (int i = 0; i < 64; ++i)
        cycle.push_back(static_cast<float>(std::sin(2 * pi * i / 64.0)));
    const array a = row(3);
    stroke s{
        "", trajectory::timed({{0.0, {0, 0}}, {1.0, {20, 0}}, {2.0, {20, 0}}, {6.0, {40, 0}}}), {}, {}, {}};
    s.sound.wave = recorded(cycle, texture_kind::length);
    s.sound.wave->texture_mm = 10.0;
    render_options r{.ramp_s = 0.0, .level_dbfs = 0.0};
    const score made(a, make_plan(a, s, {.algorithm = algorithm_kind::continuous}), r);
    const auto bytes = render(made, format_kind::float32);
    const auto at = [&](double t_s, unsigned c) {
        return static_cast<double>(sample<float>(bytes, static_cast<std::size_t>(t_s * rate) * 3 + c));
    };
    CHECK(at(0.125, 0) > 0.8);          // a quarter of the first cycle, near tactor 0
    CHECK(at(0.375, 0) < -0.7);         // three quarters of it
    CHECK(std::abs(at(1.5, 1)) == 0.0); // it rests: a constant would push
    CHECK(at(2.5, 1) > 0.7);            // 22.5 mm
    CHECK(at(5.5, 2) < -0.7);           // 37.5 mm
}

TEST_CASE("a recording sounds alike in any unit of its samples")
{
    // The second factors reach the ends of the range of floats.
    for (const texture_kind texture : {texture_kind::cycle, texture_kind::time}) {
        const auto as_it_is = played(tone(recorded(make_sine(480, 7.0, 0.75), texture), 250.0, 0.1));
        REQUIRE(greatest(as_it_is) > 0.99);
        for (const double factor : {0x1p-20, 0x1p-120, 0x1p15, 0x1p128}) {
            CAPTURE(factor);
            std::vector<float> samples = make_sine(480, 7.0, 0.75);
            for (float& v : samples)
                v = static_cast<float>(factor * static_cast<double>(v));
            const auto x = played(tone(recorded(samples, texture), 250.0, 0.1));
            REQUIRE(x.size() == as_it_is.size());
            for (std::size_t i = 0; i < x.size(); ++i)
                REQUIRE(std::abs(x[i] - as_it_is[i]) < 1e-6);
        }
    }
}

TEST_CASE("a small vibration on a large constant is played without the constant, at any rate")
{
    for (const double rate_hz : {8000.0, 48000.0, 44100.0}) {
        CAPTURE(rate_hz);
        const auto samples = static_cast<std::size_t>(rate_hz);
        const auto w = recorded(make_sine(samples, 300.0, 1e-3, 1.0), texture_kind::time, rate_hz);
        const auto x = lines(played(tone(w, 250.0)));
        CHECK(strongest(x, 300.0) == doctest::Approx(1.0).epsilon(0.02));
        CHECK(stray_db(x, 1e9, 300.0) < -60.0);
    }
}

TEST_CASE("a recording of which nothing is left is refused, not played as rounding")
{
    for (const texture_kind texture : {texture_kind::cycle, texture_kind::time, texture_kind::length}) {
        CAPTURE(std::string(to_string(texture)));
        has(refusal(recorded({0.0F, 0.0F}, texture)), "silent");
        has(refusal(recorded(std::vector<float>(700, 0.1F), texture)), "silent");
    }
    // The whole at half its own rate, without a phase, and above half the stream's.
    has(refusal(recorded({0.3F, -0.3F, 0.3F, -0.3F}, texture_kind::cycle)), "x.wav: it has no frequencies");
    has(refusal(recorded(make_sine(64, 20.0, 0.5), texture_kind::cycle), 2000.0),
        "x.wav: it has no frequencies");
    const auto high = recorded(make_sine(96000, 40000.0, 0.5), texture_kind::time, 96000.0);
    has(refusal(high), "x.wav: it has no frequencies");
}

} // namespace waveforms_test
