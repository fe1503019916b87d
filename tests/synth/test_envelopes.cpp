// SPDX-License-Identifier: MIT
// Rise and fall of bursts.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

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
    render_options o;
    o.level_dbfs = 0.0;
    o.envelope = {kind, attack_s, release_s};
    return o;
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

} // namespace

TEST_CASE("attack and release of a raised cosine have their own times")
{
    follows(with(envelope_kind::raised_cosine, 0.01, 0.03),
            [](double t) { return std::min(cosine(t / 0.01), cosine((0.1 - t) / 0.03)); });
    follows(with(envelope_kind::raised_cosine, 0.01, 0.0), [](double t) { return cosine(t / 0.01); });
    follows(with(envelope_kind::raised_cosine, 0.0, 0.03), [](double t) { return cosine((0.1 - t) / 0.03); });
}

TEST_CASE("without a release it is as long as the attack")
{
    follows(with(envelope_kind::linear, 0.02, {}), [](double t) {
        return std::min({1.0, t / 0.02, (0.1 - t) / 0.02});
    });
}

TEST_CASE("a line rises and falls evenly")
{
    follows(with(envelope_kind::linear, 0.02, 0.05), [](double t) {
        return std::min({1.0, t / 0.02, (0.1 - t) / 0.05});
    });
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
    render_options old;
    old.ramp_s = 0.01;
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
        render_options o;
        o.level_dbfs = 0.0;
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
        render_options o;
        o.envelope = e;
        return has(caught_message([&] { score(row(1), p, o); }), part);
    };
    CHECK(refused({envelope_kind::linear, -0.1, {}}, "attack_s"));
    CHECK(refused({envelope_kind::linear, {}, std::nan("")}, "release_s"));
    CHECK(refused({envelope_kind::linear, {}, 11.0}, "release_s"));
    CHECK(refused({envelope_kind::tukey, {}, {}, 1.1}, "tukey_part"));
}

} // namespace envelopes_test
