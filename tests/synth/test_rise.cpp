// SPDX-License-Identifier: MIT
// Slow actuators, which get more amplitude at first.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/render.hpp>
#include <tactor/tactor.hpp>

namespace rise_test {

using namespace tactor;

namespace {

constexpr unsigned rate = 48000;
constexpr std::size_t half_cycle = 96; // frames, at 250 Hz
constexpr double level = 0.25;
const double level_dbfs = 20.0 * std::log10(level);

array one_tactor(std::optional<double> rise_s, double max_dbfs = 0.0)
{
    array a;
    tactor_spec t;
    t.max_dbfs = max_dbfs;
    t.rise_s = rise_s;
    a.tactors = {t};
    return a;
}

plan bursts_at(std::vector<std::pair<double, double>> onsets_and_amplitudes, double duration_s)
{
    plan p;
    for (const auto& [onset_s, amplitude] : onsets_and_amplitudes) {
        burst b{.onset_s = onset_s, .duration_s = duration_s, .intensity = amplitude};
        b.drives = {{0, amplitude}};
        p.bursts.push_back(b);
        p.total_s = onset_s + duration_s;
    }
    p.stroke_duration_s = p.total_s;
    return p;
}

render_options options()
{
    render_options o;
    o.level_dbfs = level_dbfs;
    return o;
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

} // namespace rise_test
