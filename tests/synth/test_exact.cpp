// SPDX-License-Identifier: MIT
// Bursts against the formula of section 7, written out in double.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "pieces.hpp"
#include "rounds.hpp"

namespace exact_test {

using namespace tactor;
using namespace pieces;

namespace {

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
            level * e.amplitude * window(k, n, r) * std::sin(2.0 * pi * e.carrier_hz * carrier / e.rate);
    }
    return x;
}

score make_score(const example& e)
{
    render_options o;
    o.rate = e.rate;
    o.level_dbfs = e.level_dbfs;
    o.ramp_s = e.ramp_s;
    o.phase = e.phase;
    return {row(2),
            {{make_plan({make_burst(e.onset_s, e.duration_s, {{1, e.amplitude}})}, e.carrier_hz), {}}},
            o};
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

} // namespace

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

TEST_CASE("integers are the formula times 2^(bits - 1), rounded")
{
    for (const format_kind f : all_formats) {
        if (f == format_kind::float32)
            continue;
        std::size_t wrong = 0;
        std::size_t loud = 0;
        for (const example& e : examples()) {
            const score s = make_score(e);
            const auto x = formula(e, s.frames());
            const auto bytes = render(s, f);
            for (std::size_t k = 0; k < x.size(); ++k) {
                const double scaled = x[k] * full_scale(f);
                const double exact = std::min(std::nearbyint(scaled), full_scale(f) - 1.0);
                const auto got = static_cast<double>(integer(bytes, f, 2 * k + 1));
                // The two sides may fall to either side of a tie, no more.
                const bool tie = std::abs(std::abs(scaled - std::floor(scaled)) - 0.5) <
                                 1e-3 * full_scale(f) / 2147483648.0;
                wrong += got == exact || (tie && std::abs(got - exact) <= 1.0) ? 0 : 1;
                loud += std::abs(got) > 0.5 * full_scale(f) ? 1 : 0;
            }
        }
        CAPTURE(to_string(f));
        CHECK(wrong == 0);
        CHECK(loud > 1000);
    }
}

TEST_CASE("a burst of 17.5 cycles has no ramp, another has 2 ms at each end")
{
    const score plain = make_score({0.0, 0.07, 1.0, 250.0, 48000, 0.0, {}, phase_kind::burst});
    CHECK(plain.frames() == 3360);
    CHECK(channel(plain, 1)[48] == doctest::Approx(1.0));
    const score ramped = make_score({0.0, 0.0705, 1.0, 250.0, 48000, 0.0, {}, phase_kind::burst});
    CHECK(channel(ramped, 1)[48] == doctest::Approx(0.5));
    const score told = make_score({0.0, 0.07, 1.0, 250.0, 48000, 0.0, 0.002, phase_kind::burst});
    CHECK(channel(told, 1)[48] == doctest::Approx(0.5));
}

TEST_CASE("a ramp never takes more than half of the burst")
{
    const score s = make_score({0.0, 0.01, 1.0, 1000.0, 48000, 0.0, 1.0, phase_kind::burst});
    const auto x = channel(s, 1);
    CHECK(std::abs(x[252]) == doctest::Approx(window(252, 480, 240)).epsilon(1e-6));
    CHECK(std::abs(x[240 + 12]) > 0.9);
}

TEST_CASE("bursts that touch after rounding share no frame")
{
    // 0.07 s at 22050 Hz is 1543.5 frames: every other boundary is a tie.
    std::vector<burst> bursts;
    for (int k = 0; k < 40; ++k)
        bursts.push_back(make_burst(k * 0.07, 0.07, {{0, 1.0}}));
    render_options o;
    o.rate = 22050;
    o.level_dbfs = 0.0;
    const auto whole = channel(score(row(1), {{make_plan(bursts), {}}}, o), 0);
    for (std::size_t k = 0; k < whole.size(); ++k)
        REQUIRE(std::abs(whole[k] - std::sin(2.0 * pi * 250.0 * static_cast<double>(k) / 22050.0)) < 1e-6);
    o.phase = phase_kind::burst;
    const auto x = channel(score(row(1), {{make_plan(bursts), {}}}, o), 0);
    for (int k = 0; k < 40; ++k) {
        const auto n0 = static_cast<std::size_t>(std::floor(k * 1543.5 + 0.5));
        CHECK(std::abs(x[n0]) < 1e-9);
        CHECK(x[n0 + 1] == doctest::Approx(std::sin(2.0 * pi * 250.0 / 22050.0)));
    }
}

} // namespace exact_test
