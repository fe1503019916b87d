// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <span>

#include <doctest/doctest.h>

#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/mix/oscillator.hpp"
#include "synth/mix/window.hpp"

namespace oscillator_test {

using namespace tactor;
using namespace pieces;

TEST_CASE("sine and cosine are good to 4e-16")
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> some(-2.0, 2.0);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double x = some(random);
        const synth::sine_cosine v = synth::sincos_cycles(x);
        const long double angle = 2.0L * 3.14159265358979323846264L * static_cast<long double>(x);
        worst =
            std::max(worst, static_cast<double>(std::abs(static_cast<long double>(v.sin) - std::sin(angle))));
        worst =
            std::max(worst, static_cast<double>(std::abs(static_cast<long double>(v.cos) - std::cos(angle))));
    }
    CHECK(worst < 4e-16);
    CHECK(synth::sincos_cycles(0.0).sin == 0.0);
    CHECK(synth::sincos_cycles(0.25).sin == 1.0);
    CHECK(synth::sincos_cycles(-0.5).cos == -1.0);
    CHECK(synth::sincos_cycles(1e18).cos == 1.0);
    CHECK(std::isfinite(synth::sincos_cycles(std::nan("")).sin));
}

TEST_CASE("an hour of carrier stays within 1e-4 of the exact sine")
{
    // A frequency all the way (where tests do less: its end), the others in the last second of the hour.
    for (const double hz : {249.7, 250.0, 333.333, 40.0}) {
        const std::uint64_t first =
            hz == 249.7 ? 3600U - static_cast<unsigned>(tactor::test::rounds(3600)) : 3599U;
        synth::mixer m(std::vector<double>{1.0}, format_kind::float32, 4);
        synth::drive_event e;
        e.length = 3700U * 48000U;
        e.phase_frame = first * 48000;
        e.cycles_per_frame = hz / 48000.0;
        e.drives = 1;
        e.drive[0] = {1.0, 1.0, 0};
        m.add(e);
        std::vector<float> x(48000);
        double worst = 0.0;
        for (std::uint64_t second = first; second < 3601; ++second) {
            m.process(x.size(), reinterpret_cast<std::byte*>(x.data()));
            for (std::uint64_t k = 0; k < x.size(); k += 1009) {
                const std::uint64_t frame = second * 48000 + k;
                const long double cycles =
                    static_cast<long double>(hz) * static_cast<long double>(frame) / 48000.0L;
                const long double exact =
                    std::sin(2.0L * 3.14159265358979323846264L * std::fmod(cycles, 1.0L));
                worst = std::max(worst, std::abs(static_cast<double>(x[k]) - static_cast<double>(exact)));
            }
        }
        CHECK(worst < 1e-6);
    }
}

TEST_CASE("a carrier that starts after an hour has the phase of the hour")
{
    render_options o;
    o.phase = phase_kind::stroke;
    o.level_dbfs = 0.0;
    const double hz = 251.3;
    const score s(row(1), {{make_plan({make_burst(3600.0, 0.01, {{0, 1.0}})}, hz), {}}}, o);
    REQUIRE(s.frames() == 3600U * 48000U + 480U);
    renderer r(s, format_kind::float32);
    std::vector<float> x(48000);
    for (int second = 0; second < 3600; ++second)
        r.process(std::as_writable_bytes(std::span(x)));
    r.process(std::as_writable_bytes(std::span(x).first(480)));
    for (std::uint64_t k = 96; k < 384; ++k) {
        const long double cycles = 251.3L * static_cast<long double>(3600U * 48000U + k) / 48000.0L;
        const long double exact = std::sin(2.0L * 3.14159265358979323846264L * std::fmod(cycles, 1.0L));
        CHECK(std::abs(static_cast<double>(x[k]) - static_cast<double>(exact)) < 1e-6);
    }
}

TEST_CASE("more frequencies than tables only cost time")
{
    synth::oscillator_tables tables;
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 3000; ++i) {
            const double f = 0.0001 * (i + 1);
            const synth::oscillator_table& t = tables.get(f);
            CHECK(std::abs(t.sin[63] - std::sin(2.0 * pi * f * 63)) < 1e-13);
            CHECK(std::abs(t.cos[5] - std::cos(2.0 * pi * f * 5)) < 1e-13);
        }
    }
}

TEST_CASE("the window at any place is the formula")
{
    std::mt19937_64 random(9);
    synth::oscillator_tables tables;
    for (int i = 0; i < 5000; ++i) {
        const auto n = static_cast<std::int64_t>(1 + random() % 300);
        const auto r = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n / 2 + 1));
        const auto first = static_cast<std::int64_t>(random() % 500) - 100;
        const auto lo = static_cast<unsigned>(random() % synth::block_frames);
        const auto hi = lo + static_cast<unsigned>(random() % (synth::block_frames + 1 - lo));
        synth::block x;
        x.fill(1.0);
        synth::window_block(tables, first, static_cast<std::uint64_t>(n), static_cast<std::uint64_t>(r), lo,
                            hi, x.data());
        for (unsigned j = lo; j < hi; ++j) {
            const std::int64_t k = first + j;
            const double exact = r == 0 ? 1.0 : (k < 0 || k >= n ? 0.0 : window(k, n, r));
            REQUIRE(std::abs(x[j] - exact) < 1e-14);
            if (r != 0 && k >= 0 && k < n) {
                REQUIRE(std::abs(synth::window_at(k, static_cast<std::uint64_t>(n),
                                                  static_cast<std::uint64_t>(r)) -
                                 exact) < 1e-14);
            }
        }
    }
}

} // namespace oscillator_test
