// SPDX-License-Identifier: MIT
// Oscillators, the start of the phase, blocks of any size, and sample formats.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/limits/guard.hpp"
#include "synth/mix/converter.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/wave/oscillator.hpp"
#include "synth/wave/window.hpp"

namespace oscillator_test {

using namespace tactor;
using namespace pieces;

namespace {

std::vector<score> various()
{
    std::mt19937_64 random(11);
    std::vector<score> all;
    for (const phase_kind phase : {phase_kind::burst, phase_kind::stroke}) {
        for (const overlap_kind join : {overlap_kind::energy, overlap_kind::max, overlap_kind::sum}) {
            for (const unsigned rate : {8000U, 44100U, 48000U}) {
                render_options o{.rate = rate, .phase = phase, .level_dbfs = -30.0, .channels = 7};
                plan a = make_random(random, 5, 30, 0.4);
                plan b = make_random(random, 5, 10, 0.3);
                a.overlap = b.overlap = join;
                all.emplace_back(
                    row(5), std::vector<placed_plan>{{a, {}}, {make_continuous(5, 0.31), 0.1}, {b, 0.25}}, o);
            }
        }
    }
    return all;
}

std::vector<std::byte> converted(format_kind f, const std::vector<double>& x)
{
    std::vector<std::byte> out(x.size() * sample_bytes(f));
    for (std::size_t i = 0; i < x.size(); i += 64) {
        const auto n = static_cast<unsigned>(std::min<std::size_t>(64, x.size() - i));
        const synth::channel_samples one[] = {{0, x.data() + i, 1.0}};
        synth::interleave(f, one, 1, n, out.data() + i * sample_bytes(f));
    }
    return out;
}

} // namespace

TEST_CASE("sine and cosine are good to 4e-16")
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> some(-2.0, 2.0);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double x = some(random);
        const synth::sine_cosine v = synth::sincos_turns(x);
        const long double angle = 2.0L * 3.14159265358979323846264L * static_cast<long double>(x);
        worst =
            std::max(worst, static_cast<double>(std::abs(static_cast<long double>(v.sin) - std::sin(angle))));
        worst =
            std::max(worst, static_cast<double>(std::abs(static_cast<long double>(v.cos) - std::cos(angle))));
    }
    CHECK(worst < 4e-16);
    CHECK(synth::sincos_turns(0.0).sin == 0.0);
    CHECK(synth::sincos_turns(0.25).sin == 1.0);
    CHECK(synth::sincos_turns(-0.5).cos == -1.0);
}

TEST_CASE("an hour of carrier stays within 1e-4 of the exact sine")
{
    // A frequency all the way (where tests do less: its end), the others in the last second of the hour.
    for (const double hz : {249.7, 250.0, 333.333, 40.0}) {
        const std::uint64_t first =
            hz == 249.7 ? 3600U - static_cast<unsigned>(tactor::test::rounds(3600)) : 3599U;
        synth::mixer m(std::vector<double>{1.0}, format_kind::float32, 4);
        synth::drive_event e = make_event(0, 3700U * 48000U, hz / 48000.0, {1.0, 1.0, 0});
        e.phase_frame = first * 48000;
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
        const auto ramp = static_cast<std::uint32_t>(r);
        const synth::burst_window w{static_cast<std::uint64_t>(n), ramp, ramp};
        synth::block x;
        x.fill(1.0);
        synth::window_block(tables, first, w, lo, hi, x.data());
        for (unsigned j = lo; j < hi; ++j) {
            const std::int64_t k = first + j;
            const double exact = r == 0 ? 1.0 : (k < 0 || k >= n ? 0.0 : window(k, n, r));
            REQUIRE(std::abs(x[j] - exact) < 1e-14);
            if (r != 0 && k >= 0 && k < n)
                REQUIRE(std::abs(synth::window_at(k, w) - exact) < 1e-14);
        }
    }
}

TEST_CASE("the carrier counts from its stroke's first frame, at any start")
{
    // 240 Hz: no burst except the first begins on a crossing, so each sample depends on the count.
    const double hz = 240.0;
    plan p = make_plan({make_burst(0.011, 0.1, {{0, 0.6}}), make_burst(0.17, 0.05, {{0, 0.5}})}, hz);
    for (const double start_s : {0.0, 0.2501}) {
        const score s(row(1), {{p, start_s}}, {.ramp_s = 0.0, .level_dbfs = 0.0});
        const auto x = channel(s, 0);
        const std::size_t first = s.starts()[0];
        for (std::size_t k = first; k < x.size(); ++k) {
            const std::size_t at = k - first;
            const double a = at >= 528 && at < 5328 ? 0.6 : (at >= 8160 ? 0.5 : 0.0);
            REQUIRE(std::abs(x[k] - a * sine(hz, at)) < 1e-6);
        }
    }
}

TEST_CASE("overlapping bursts continue the stroke's carrier")
{
    const double hz = 240.0;
    const plan p = make_plan({make_burst(0.011, 0.1, {{0, 0.6}}), make_burst(0.06, 0.1, {{0, 0.5}})}, hz);
    const auto x = channel(score(row(1), {{p, 0.2501}}, {.ramp_s = 0.0, .level_dbfs = 0.0}), 0);
    const std::size_t first = 12005;
    for (std::size_t at = 528; at < 2880; ++at)
        REQUIRE(std::abs(x[first + at] - 0.6 * sine(hz, at)) < 1e-6);
}

TEST_CASE("a burst has no ramp where the carrier crosses zero at both its ends, else 2 ms")
{
    // From the stroke's start in half cycles of 2 ms; 0.02 ms is 1 % of one.
    struct example {
        double onset_s;
        double duration_s;
        bool ramped;
        bool ramped_alone; ///< where the carrier restarts
    };
    const example all[] = {
        {0.0, 0.07, false, false},      {0.070, 0.07, false, false},     {0.07001, 0.07, false, false},
        {0.0705, 0.07, true, false},    {0.0705, 0.0695, true, true},    {0.0, 0.0705, true, true},
        {0.07, 0.000019, true, true},   {0.0700195, 0.0, true, true},    {0.07003, 0.07, true, false},
        {0.070, 0.06999, false, false}, {0.07001, 0.07002, true, false},
    };
    for (const example& e : all) {
        for (const phase_kind phase : {phase_kind::stroke, phase_kind::burst}) {
            const render_options o{.rate = 768000, .phase = phase, .level_dbfs = 0.0};
            const plan p = make_plan({make_burst(e.onset_s, e.duration_s, {{0, 1.0}})});
            const auto x = channel(score(row(1), {{p, {}}}, o), 0);
            const bool expected = phase == phase_kind::stroke ? e.ramped : e.ramped_alone;
            const auto first = static_cast<std::size_t>(std::llround(e.onset_s * o.rate));
            const std::size_t quarter = first + 768; // 1 ms, half way up a ramp of 2 ms
            if (quarter + 768 >= x.size())
                continue; // the shortest ones only have to be accepted
            CAPTURE(e.onset_s);
            CAPTURE(e.duration_s);
            CAPTURE(static_cast<int>(phase));
            const double from = phase == phase_kind::stroke ? static_cast<double>(quarter) : 768.0;
            CHECK(x[quarter] / sine(250.0, from, o.rate) ==
                  doctest::Approx(expected ? 0.5 : 1.0).epsilon(0.01));
        }
    }
}

TEST_CASE("an explicit ramp wins in either phase")
{
    for (const phase_kind phase : {phase_kind::stroke, phase_kind::burst}) {
        const auto played = [phase](double hz, double ramp_s) {
            const plan p = make_plan({make_burst(0.0, 0.07, {{0, 1.0}})}, hz);
            return channel(score(row(1), p, {.phase = phase, .ramp_s = ramp_s, .level_dbfs = 0.0}), 0);
        };
        CHECK(played(250.0, 0.002)[48] == doctest::Approx(0.5));
        CHECK(played(255.0, 0.0)[47] == doctest::Approx(sine(255.0, 47)));
    }
}

TEST_CASE("any block size gives the same bytes")
{
    std::mt19937_64 random(3);
    const std::vector<score> all = various();
    for (int i = 0; i < tactor::test::rounds(18); ++i) {
        const score& s = all[static_cast<std::size_t>(i) * 7 % all.size()]; // all 18, or a few different ones
        for (const format_kind f : all_formats) {
            const auto whole = render(s, f);
            const std::size_t sizes[] = {1, 7, 63, 64, 65, 96, 1000, 4096};
            const std::size_t largest = sizes[random() % 8];
            const auto parts = render(
                s, f, [&] { return 1 + random() % largest; }, s.frames());
            CHECK((whole == parts));
            const std::size_t fixed = sizes[random() % 8];
            CHECK((whole == render(
                                s, f, [&] { return fixed; }, s.frames())));
        }
    }
}

TEST_CASE("the renderer goes on in silence after the end")
{
    const score s = various().front();
    const auto longer = render(
        s, format_kind::s16, [] { return 100; }, s.frames() + 1000);
    const auto exact = render(s, format_kind::s16);
    CHECK(std::equal(exact.begin(), exact.end(), longer.begin()));
    CHECK(std::all_of(longer.begin() + static_cast<std::ptrdiff_t>(exact.size()), longer.end(),
                      [](std::byte b) { return b == std::byte{0}; }));
}

TEST_CASE("a part of a frame is refused and writes nothing; an empty block is accepted")
{
    const score s = various().front();
    renderer r(s, format_kind::s16);
    std::vector<std::byte> out(100 * s.channels() * 2 + 1, std::byte{0x55});
    CHECK_THROWS_WITH_AS(r.process(out), doctest::Contains("whole number of frames"), error);
    CHECK(r.position() == 0);
    CHECK(std::all_of(out.begin(), out.end(), [](std::byte b) { return b == std::byte{0x55}; }));
    r.process({});
    CHECK(r.position() == 0);
    r.process(std::span(out).first(100 * s.channels() * 2));
    CHECK(r.position() == 100);
}

TEST_CASE("a stroke has the same bytes at any start")
{
    std::mt19937_64 random(23);
    for (int i = 0; i < 20; ++i) {
        const plan parts[] = {make_random(random, 3, 12, 0.2), make_continuous(3, 0.1)};
        for (const plan& p : parts) {
            const double later_s = 1.0 + static_cast<double>(random() % 100000) / 48000.0;
            render_options o{.level_dbfs = -20.0};
            const score first(row(3), {{p, {}}}, o);
            const score later(row(3), {{p, later_s}}, o);
            for (const format_kind f : {format_kind::float32, format_kind::s32}) {
                const auto x = render(first, f);
                const auto y = render(later, f);
                REQUIRE(y.size() - x.size() == later.starts()[0] * 12);
                CHECK(std::equal(x.begin(), x.end(),
                                 y.begin() + static_cast<std::ptrdiff_t>(y.size() - x.size())));
            }
        }
    }
}

TEST_CASE("full scale does not wrap in any format")
{
    const std::vector<double> x{1.0, -1.0, 1.0 - 1e-12, -1.0 + 1e-12, 1.0 + 1e-12, -1.0 - 1e-12};
    for (const format_kind f : all_formats) {
        const auto bytes = converted(f, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CAPTURE(to_string(f));
            CAPTURE(x[i]);
            if (f == format_kind::float32) {
                CHECK(std::abs(static_cast<double>(sample<float>(bytes, i)) - x[i]) < 1e-6);
            } else {
                const double want = x[i] > 0.0 ? full_scale(f) - 1.0 : -full_scale(f);
                CHECK(std::abs(static_cast<double>(integer(bytes, f, i)) - want) <=
                      (f == format_kind::s32 ? 1.0 : 0.0));
            }
        }
    }
    CHECK(integer(converted(format_kind::s32, {1.0}), format_kind::s32, 0) == 2147483647);
    CHECK(integer(converted(format_kind::s32, {-1.0}), format_kind::s32, 0) == -2147483648LL);
}

TEST_CASE("integers are rounded to the nearest, ties to even")
{
    for (const format_kind f : all_formats) {
        if (f == format_kind::float32)
            continue;
        std::vector<double> x;
        for (int i = -1000; i <= 1000; ++i)
            x.push_back(0.125 * i / full_scale(f));
        const auto bytes = converted(f, x);
        for (std::size_t i = 0; i < x.size(); ++i)
            CHECK(static_cast<double>(integer(bytes, f, i)) == std::nearbyint(x[i] * full_scale(f)));
    }
}

TEST_CASE("silence has no negative zeros")
{
    const auto bytes = converted(format_kind::float32, {-0.0, 0.0, -1e-300});
    CHECK(sample<std::uint32_t>(bytes, 0) == 0U);
    CHECK(sample<std::uint32_t>(bytes, 1) == 0U);
}

TEST_CASE("what is not a number is silent in every format, and its neighbours are not")
{
    for (const format_kind f : all_formats)
        CHECK(converted(f, {0.5, std::nan(""), -std::nan(""), -0.25}) ==
              converted(f, {0.5, 0.0, 0.0, -0.25}));
}

TEST_CASE("for any sounding channels, each sample is in its place and the others are silent")
{
    std::mt19937_64 random(3);
    std::vector<double> x(synth::block_frames);
    for (double& v : x)
        v = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    for (int i = 0; i < 3000; ++i) {
        const format_kind f = all_formats[random() % std::size(all_formats)];
        const auto channels = 1 + random() % 20;
        const auto n = static_cast<unsigned>(1 + random() % 70);
        std::vector<synth::channel_samples> sounding;
        for (std::uint32_t c = 0; c < channels; ++c)
            if (random() % 2 == 0)
                sounding.push_back({c, x.data() + c, 0.1 * (c + 1)});
        std::vector<std::byte> out(n * channels * sample_bytes(f) + 16, std::byte{0x55});
        synth::interleave(f, sounding, channels, n, out.data());
        std::vector<std::byte> want(out.size(), std::byte{0x55});
        std::fill(want.begin(), want.end() - 16, std::byte{});
        for (const synth::channel_samples& c : sounding) {
            for (std::size_t k = 0; k < n; ++k) {
                const auto one = converted(f, {c.gain * c.x[k]});
                std::copy(one.begin(), one.end(),
                          want.begin() +
                              static_cast<std::ptrdiff_t>((k * channels + c.channel) * sample_bytes(f)));
            }
        }
        REQUIRE(out == want);
    }
}

TEST_CASE("the limiter clamps, silences non-numbers, and counts")
{
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<double> x{0.0, 0.4, -0.5, 0.6, -7.0, inf, -inf, std::nan("")};
    CHECK(synth::limit_block(x.data(), 8, 0.5) == 5);
    CHECK((x == std::vector<double>{0.0, 0.4, -0.5, 0.5, -0.5, 0.5, -0.5, 0.0}));
    CHECK(synth::limit_block(x.data(), 8, 0.5) == 0);
    CHECK(synth::limit_block(x.data(), 8, 0.0) == 6);
    std::vector<double> noise{0.5 * (1.0 + 4e-16)};
    CHECK(synth::limit_block(noise.data(), 1, 0.5) == 0);
    CHECK(noise[0] == 0.5);
}

TEST_CASE("sample formats have names and sizes")
{
    for (const format_kind f : all_formats)
        CHECK(from_string<format_kind>(to_string(f)) == f);
    CHECK(from_string<format_kind>("s24") == format_kind::s24_3);
    CHECK(from_string<format_kind>("s24-4") == format_kind::s24_4);
    CHECK(sample_bytes(format_kind::s24_3) == 3);
    CHECK(sample_bytes(format_kind::s24_4) == 4);
    CHECK(sample_bytes(format_kind::s16) == 2);
    CHECK_THROWS_AS(from_string<format_kind>("s25"), error);
    CHECK_THROWS_AS(from_string<format_kind>(""), error);
}

} // namespace oscillator_test
