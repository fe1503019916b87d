// SPDX-License-Identifier: MIT
// Envelopes, and slow actuators, which get more amplitude at first.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/render.hpp>
#include <tactor/tactor.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "pieces.hpp"

namespace envelopes_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 48000;

/// Divides the samples of a burst at 1 kHz by the carrier's where that is not small: the window.
std::vector<double> measure_window(const render_options& o, double duration_s = 0.1)
{
    const plan p = pieces::make_plan({make_burst(0.0, duration_s, {{0, 1.0}})}, 1000.0);
    const auto x = channel(score(row(1), p, o), 0);
    std::vector<double> w(x.size(), -1.0);
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double s = std::sin(2 * pi * 1000.0 * static_cast<double>(k) / rate);
        if (std::abs(s) > 0.3)
            w[k] = x[k] / s;
    }
    return w;
}

render_options with(envelope_kind kind, std::optional<double> attack_s, std::optional<double> release_s)
{
    return {.level_dbfs = 0.0, .envelope = {kind, attack_s, release_s}};
}

void follows(const render_options& o, const std::function<double(double t_s)>& expected,
             double duration_s = 0.1)
{
    const auto w = measure_window(o, duration_s);
    for (std::size_t k = 0; k < w.size(); ++k) {
        if (w[k] >= 0.0) {
            CAPTURE(k);
            REQUIRE(std::abs(w[k] - expected(static_cast<double>(k) / rate)) < 1e-6);
        }
    }
}

double cosine(double part)
{
    return part >= 1.0 ? 1.0 : 0.5 - 0.5 * std::cos(pi * part);
}

constexpr std::size_t half_cycle = 96; // frames, at 250 Hz
constexpr double level = 0.25;
const double level_dbfs = 20.0 * std::log10(level);

array one_tactor(std::optional<double> rise_s, double max_dbfs = 0.0)
{
    array a = row(1);
    a.tactors[0].max_dbfs = max_dbfs;
    a.tactors[0].rise_s = rise_s;
    return a;
}

plan bursts_at(const std::vector<std::pair<double, double>>& onsets_and_amplitudes, double duration_s)
{
    std::vector<burst> all;
    for (const auto& [onset_s, amplitude] : onsets_and_amplitudes)
        all.push_back(make_burst(onset_s, duration_s, {{0, amplitude}}, amplitude));
    return pieces::make_plan(std::move(all));
}

render_options options()
{
    return {.level_dbfs = level_dbfs};
}

std::vector<float> samples(const score& s)
{
    std::vector<float> x(s.frames() * s.channels());
    renderer r(s, format_kind::float32);
    r.process(std::as_writable_bytes(std::span(x)));
    return x;
}

std::vector<float> samples(const array& a, const plan& p, const render_options& o = options())
{
    return samples(score(a, p, o));
}

// Returns the carrier's amplitude in each of its half cycles.
std::vector<double> amplitudes(const std::vector<float>& x)
{
    std::vector<double> all;
    for (std::size_t at = 0; at + half_cycle <= x.size(); at += half_cycle) {
        double sum = 0.0;
        for (std::size_t k = at; k < at + half_cycle; ++k)
            sum += static_cast<double>(x[k]) *
                   std::sin(std::numbers::pi * static_cast<double>(k) / static_cast<double>(half_cycle));
        all.push_back(2.0 * sum / half_cycle);
    }
    return all;
}

// Returns the actuator's response at the end of each half cycle.
std::vector<double> followed(const std::vector<double>& driven, double rise_s)
{
    const double kept = std::exp(-static_cast<double>(half_cycle) / rate / rise_s);
    std::vector<double> y;
    double now = 0.0;
    for (const double u : driven)
        y.push_back(now = kept * now + (1.0 - kept) * u);
    return y;
}

float peak(const std::vector<float>& x)
{
    return std::abs(
        *std::max_element(x.begin(), x.end(), [](float a, float b) { return std::abs(a) < std::abs(b); }));
}

} // namespace

TEST_CASE("attack and release of a raised cosine have their own times")
{
    follows(with(envelope_kind::raised_cosine, 0.01, 0.03),
            [](double t) { return std::min(cosine(t / 0.01), cosine((0.1 - t) / 0.03)); });
    follows(with(envelope_kind::raised_cosine, 0.01, 0.0), [](double t) { return cosine(t / 0.01); });
    follows(with(envelope_kind::raised_cosine, 0.0, 0.03), [](double t) { return cosine((0.1 - t) / 0.03); });
}

TEST_CASE("an exponential ends after five time constants")
{
    const double all = 1.0 - std::exp(-5.0);
    follows(with(envelope_kind::exponential, 0.02, 0.04), [all](double t) {
        const double rise = t < 0.02 ? (1.0 - std::exp(-5.0 * t / 0.02)) / all : 1.0;
        const double fall = t > 0.06 ? (std::exp(-5.0 * (t - 0.06) / 0.04) - std::exp(-5.0)) / all : 1.0;
        return rise * fall;
    });
}

TEST_CASE("Tukey's ramps are a part of the burst")
{
    for (const double part : {0.0, 0.25, 0.5, 1.0}) {
        for (const double duration_s : {0.1, 0.04}) {
            render_options o = with(envelope_kind::tukey, {}, {});
            o.envelope.tukey_part = part;
            follows(
                o,
                [=](double t) {
                    const double ramp = 0.5 * part * duration_s;
                    return ramp == 0.0 ? 1.0 : std::min(cosine(t / ramp), cosine((duration_s - t) / ramp));
                },
                duration_s);
        }
    }
}

TEST_CASE("ramps that do not fit are shortened alike")
{
    follows(with(envelope_kind::linear, 0.15, 0.05),
            [](double t) { return std::min(t / 0.075, (0.1 - t) / 0.025); });
}

TEST_CASE("bursts that overlap on a tactor keep their envelopes")
{
    plan p = pieces::make_plan({make_burst(0.0, 0.1, {{0, 0.3}}), make_burst(0.05, 0.1, {{0, 0.3}})}, 1000.0);
    p.overlap = overlap_kind::max;
    const auto x = channel(score(row(1), p, with(envelope_kind::linear, 0.02, 0.04)), 0);
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double t = static_cast<double>(k) / rate;
        const double s = std::sin(2 * pi * 1000.0 * t);
        const auto w = [](double u) {
            return u < 0.0 || u > 0.1 ? 0.0 : std::min({1.0, u / 0.02, (0.1 - u) / 0.04});
        };
        REQUIRE(std::abs(x[k] - 0.3 * std::max(w(t), w(t - 0.05)) * s) < 2e-3);
    }
}

TEST_CASE("equal ramps on both sides give the bytes of a single ramp")
{
    render_options old{.ramp_s = 0.01};
    const plan p = pieces::make_plan({make_burst(0.0, 0.1, {{0, 1.0}}), make_burst(0.1, 0.1, {{0, 0.5}})});
    render_options now;
    now.envelope.attack_s = 0.01;
    const array a = row(1);
    CHECK(render(score(a, p, old), format_kind::float32) == render(score(a, p, now), format_kind::float32));
    now.envelope.release_s = 0.01;
    CHECK(render(score(a, p, old), format_kind::float32) == render(score(a, p, now), format_kind::float32));
    CHECK(burst_ramp_s(0.0, 0.1, p, now) == 0.01);
    CHECK(burst_ramp_s(0.0, 0.1, p, with(envelope_kind::tukey, {}, {})) == doctest::Approx(0.025));
}

TEST_CASE("waves without zero crossings at their ends have the ramp of 2 ms")
{
    plan p = pieces::make_plan({make_burst(0.0, 0.1, {{0, 1.0}})});
    CHECK(burst_ramp_s(0.0, 0.1, p, {}) == 0.0);
    p.wave.kind = waveform_kind::noise;
    CHECK(burst_ramp_s(0.0, 0.1, p, {}) == 0.002);
    p.wave.kind = waveform_kind::square;
    CHECK(burst_ramp_s(0.0, 0.1, p, {}) == 0.0);
    p.course = {{0.0, 100.0}, {0.1, 200.0}};
    CHECK(burst_ramp_s(0.0, 0.1, p, {}) == 0.002);
}

TEST_CASE("a continuous stroke has the ramp of 2 ms by default where its carrier is not at zero at its end")
{
    for (const auto& [duration_s, half] : {std::pair{0.1, 1.0}, {0.1013, 0.5}}) {
        CAPTURE(duration_s);
        plan p;
        p.carrier_hz = 250.0;
        p.total_s = p.stroke_duration_s = duration_s;
        p.curve = tactor::test::make_curve(duration_s, [](double, burst& out) { out.drives = {{0, 1.0}}; });
        render_options o{.level_dbfs = 0.0};
        // Not the first stroke of the piece, nor at a zero of its carrier.
        const score s(row(1), {{p, 0.0117}}, o);
        const auto x = channel(s, 0);
        const std::size_t start = s.starts()[0];
        CHECK(x[start + 48] == doctest::Approx(half)); // the crest in the middle of 2 ms
        CHECK(x[start + 144] == doctest::Approx(-1.0));
        // It falls as it has risen, to almost nothing in its last frames.
        if (half < 1.0) {
            double last = 0.0;
            for (std::size_t k = x.size() - 10; k < x.size(); ++k)
                last = std::max(last, std::abs(x[k]));
            CHECK(last > 0.0);
            CHECK(last < 0.03);
        }
        o.ramp_s = 0.004;
        CHECK(channel(score(row(1), {{p, 0.0117}}, o), 0)[start + 48] ==
              doctest::Approx(0.1464).epsilon(1e-3));
    }
}

TEST_CASE("impossible envelopes are refused")
{
    const plan p = pieces::make_plan({make_burst(0.0, 0.1, {{0, 1.0}})});
    const auto refused = [&](const burst_envelope& e, const std::string& part) {
        return has(caught_message([&] { score(row(1), p, {.envelope = e}); }), part);
    };
    CHECK(refused({envelope_kind::linear, -0.1, {}}, "attack_s"));
    CHECK(refused({envelope_kind::linear, {}, std::nan("")}, "release_s"));
    CHECK(refused({envelope_kind::linear, {}, 11.0}, "release_s"));
    CHECK(refused({envelope_kind::tukey, {}, {}, 1.1}, "tukey_part"));
}

TEST_CASE("an actuator reaches the strength of a burst as soon as its limit allows, and keeps it")
{
    for (const double rise_s : {0.002, 0.01, 0.02, 0.05}) {
        for (const double max_dbfs : {0.0, -6.0}) {
            CAPTURE(rise_s);
            CAPTURE(max_dbfs);
            const auto x = samples(one_tactor(rise_s, max_dbfs), bursts_at({{0.0, 1.0}}, 0.2));
            const double limit = std::pow(10.0, max_dbfs / 20.0);
            CHECK(peak(x) <= limit);
            // At the limit it would be there after this time.
            const double soonest_s = rise_s * std::log(limit / (limit - level));
            const auto there = static_cast<std::size_t>(soonest_s * rate / half_cycle) + 1;
            const std::vector<double> y = followed(amplitudes(x), rise_s);
            REQUIRE(there < y.size());
            for (std::size_t k = 0; k < y.size(); ++k) {
                CAPTURE(k);
                CHECK(y[k] <= level * 1.001);
                CHECK((k + 1 < there || y[k] >= level * 0.999));
            }
        }
    }
}

TEST_CASE("an unmeasured actuator is left as it is")
{
    const plan p = bursts_at({{0.0, 1.0}, {0.1, 0.5}}, 0.07);
    const auto plain = samples(one_tactor({}), p);
    CHECK(peak(plain) == doctest::Approx(level).epsilon(1e-4));
    CHECK(samples(one_tactor(0.02, level_dbfs), p) == plain); // without any room below its limit
    CHECK(samples(one_tactor(0.02), p) != plain);
}

TEST_CASE("a burst that follows another needs only the missing strength")
{
    const double rise_s = 0.02;
    const auto touching =
        samples(one_tactor(rise_s), bursts_at({{0.0, 1.0}, {0.08, 1.0}, {0.16, 0.5}}, 0.08));
    const std::vector<double> u = amplitudes(touching);
    for (std::size_t k = 20; k < 80; ++k)
        CHECK(u[k] == doctest::Approx(level).epsilon(1e-4));
    const auto paused = samples(one_tactor(rise_s), bursts_at({{0.0, 1.0}, {0.1, 1.0}}, 0.08));
    const std::vector<double> v = amplitudes(paused);
    const std::vector<double> y = followed(v, rise_s);
    CHECK(v[50] > level * 1.2); // it has lost 1 - 1/e of its strength
    double given = 0.0;
    double at_first = 0.0;
    for (std::size_t k = 0; k < 40; ++k) {
        at_first += v[k] - level;
        given += v[50 + k] - level;
    }
    CHECK(given == doctest::Approx(at_first * (1.0 - std::exp(-1.0))).epsilon(0.05));
    for (std::size_t k = 60; k < 90; ++k)
        CHECK(y[k] == doctest::Approx(level).epsilon(1e-3));
}

TEST_CASE("ramps are compensated unchanged")
{
    render_options o = options();
    o.ramp_s = 0.01;
    const double rise_s = 0.02;
    for (const envelope_kind kind :
         {envelope_kind::raised_cosine, envelope_kind::linear, envelope_kind::exponential}) {
        o.envelope.kind = kind;
        const std::vector<double> y =
            followed(amplitudes(samples(one_tactor(rise_s), bursts_at({{0.0, 1.0}}, 0.2), o)), rise_s);
        CHECK(*std::max_element(y.begin(), y.end()) < level * 1.02);
        for (std::size_t k = 30; k < 94; ++k)
            CHECK(y[k] == doctest::Approx(level).epsilon(0.003));
    }
}

TEST_CASE("the limits hold where strokes overlap, and levels that fit still do")
{
    const array a = one_tactor(0.03, -3.0);
    const plan p = bursts_at({{0.0, 1.0}, {0.1, 1.0}}, 0.07);
    std::vector<placed_plan> both{{p, 0.0}, {p, 0.01}};
    CHECK(peak(samples(score(a, both, options()))) <= std::pow(10.0, -3.0 / 20.0) * (1.0 + 1e-9));
    render_options loud = options();
    loud.level_dbfs = -9.1; // twice of it is -3.1
    CHECK_NOTHROW(score(a, both, loud));
}

TEST_CASE("bursts shorter than a half cycle, and actuators slower than any burst, are accepted")
{
    const plan quick = bursts_at({{0.0, 1.0}, {0.01, 1.0}}, 0.001);
    CHECK(peak(samples(one_tactor(0.02), quick)) <= 1.0F);
    const auto slow = samples(one_tactor(1.0), bursts_at({{0.0, 1.0}}, 0.07));
    const std::vector<double> u = amplitudes(slow);
    for (const double v : u)
        CHECK(v == doctest::Approx(1.0).epsilon(0.01)); // the whole strength, to its end
}

} // namespace envelopes_test
