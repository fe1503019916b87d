// SPDX-License-Identifier: MIT
// Recordings as carriers: in cycles, in time, along the path; and recordings of which little or nothing is
// left.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "tones.hpp"

namespace recorded_waves_test {

using namespace tactor;
using namespace tones;
using namespace pieces;

namespace {

std::vector<float> make_sine(std::size_t samples, double cycles, double amplitude, double offset = 0.0)
{
    std::vector<float> x(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        const double turns = cycles * static_cast<double>(i) / static_cast<double>(samples);
        x[i] = static_cast<float>(offset + amplitude * std::sin(2 * pi * turns));
    }
    return x;
}

std::string refusal(const waveform& w, double hz = 250.0)
{
    return caught_message([&] { static_cast<void>(played(tone(w, hz, 0.1))); });
}

} // namespace

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
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    render_options r;
    r.level_dbfs = 0.0;
    r.ramp_s = 0.0;
    const score made(a, make_plan(a, s, o), r);
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

TEST_CASE("the greatest and least floats give neither infinities nor non-numbers")
{
    constexpr float most = std::numeric_limits<float>::max();
    constexpr float least = std::numeric_limits<float>::denorm_min();
    const std::vector<std::vector<float>> all{{most, -most, -most, most, most},
                                              {most, 0.0F, 0.0F},
                                              {least, 0.0F, -least},
                                              {most, least, -most, 1.0F},
                                              {most, most, -most}};
    for (const auto& samples : all) {
        for (const texture_kind texture : {texture_kind::cycle, texture_kind::time}) {
            for (const double rate_hz : {8000.0, 48000.0}) {
                const auto x = played(tone(recorded(samples, texture, rate_hz), 250.0, 0.1));
                REQUIRE(std::all_of(x.begin(), x.end(), [](double v) { return std::abs(v) <= 1.0 + 1e-6; }));
                REQUIRE(greatest(x) > 0.5);
            }
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
        CHECK(has(refusal(recorded({0.0F, 0.0F}, texture)), "silence"));
        CHECK(has(refusal(recorded(std::vector<float>(700, 0.1F), texture)), "silence"));
    }
    // The whole at half its own rate, without a phase, and above half the stream's.
    CHECK(has(refusal(recorded({0.3F, -0.3F, 0.3F, -0.3F}, texture_kind::cycle)),
              "x.wav: nothing of it is left"));
    CHECK(has(refusal(recorded(make_sine(64, 20.0, 0.5), texture_kind::cycle), 2000.0),
              "x.wav: nothing of it is left"));
    const auto high = recorded(make_sine(96000, 40000.0, 0.5), texture_kind::time, 96000.0);
    CHECK(has(refusal(high), "x.wav: nothing of it is left"));
}

} // namespace recorded_waves_test
