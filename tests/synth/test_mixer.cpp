// SPDX-License-Identifier: MIT
#include "synth/mix/mixer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "pieces.hpp"

namespace mixer_test {

using namespace tactor;
using namespace pieces;
using synth::drive_event;
using synth::mixer;

namespace {

constexpr double hz = 250.0;

drive_event make_event(std::uint64_t start, std::uint32_t length, std::uint32_t channel, double from,
                       double to)
{
    return pieces::make_event(start, length, hz / 48000.0, {from, to, channel});
}

drive_event make_event(std::uint64_t start, std::uint32_t length, double a = 0.5)
{
    return make_event(start, length, 0, a, a);
}

/// A curve that bends at its quarters.
drive_event make_line(std::uint64_t start, std::uint32_t length, std::uint32_t channel,
                      const std::array<double, 5>& amplitudes)
{
    drive_event e = make_event(start, length, channel, 0.0, 0.0);
    e.drives = 0;
    e.points = 5;
    e.line = {};
    e.line.channel = channel;
    for (unsigned i = 0; i < 5; ++i) {
        e.line.amplitude[i] = amplitudes[i];
        e.line.frame[i] = static_cast<std::uint16_t>(length / 4 * i);
    }
    return e;
}

constexpr std::size_t channels = 2;

mixer make_mixer(std::size_t capacity = 64)
{
    return {std::vector<double>(channels, 1.0), format_kind::float32, capacity};
}

std::vector<float> take(mixer& m, std::size_t frames, std::size_t block = 48)
{
    std::vector<float> x(frames * channels, 7.0F);
    for (std::size_t done = 0; done < frames;) {
        const std::size_t n = std::min(block, frames - done);
        m.process(n, reinterpret_cast<std::byte*>(x.data() + done * channels));
        done += n;
    }
    return x;
}

bool silent(const std::vector<float>& x)
{
    return std::all_of(x.begin(), x.end(), [](float v) { return v == 0.0F; });
}

} // namespace

TEST_CASE("a drive sounds at its place and nowhere else")
{
    mixer m = make_mixer();
    CHECK(m.add(make_event(100, 200)));
    CHECK(m.size() == 1);
    const auto x = take(m, 400);
    for (std::size_t k = 0; k < 400; ++k) {
        const double exact = k < 100 || k >= 300 ? 0.0 : 0.5 * sine(hz, k - 100);
        CHECK(std::abs(static_cast<double>(x[2 * k]) - exact) < 1e-7);
        CHECK(x[2 * k + 1] == 0.0F);
    }
    CHECK(m.size() == 0);
    CHECK(m.position() == 400);
}

TEST_CASE("amplitudes are linear from the first frame to the frame after the last")
{
    mixer m = make_mixer();
    m.add(make_event(10, 300, 1, 0.2, -0.4));
    const auto x = take(m, 400, 7);
    for (std::size_t k = 0; k < 300; ++k) {
        const double a = 0.2 - 0.6 * static_cast<double>(k) / 300.0;
        CHECK(std::abs(static_cast<double>(x[2 * (k + 10) + 1]) - a * sine(hz, k)) < 1e-7);
    }
}

TEST_CASE("a late drive starts in its middle with the right phase and window")
{
    for (const std::uint64_t late : {1U, 63U, 64U, 100U, 290U}) {
        drive_event e = make_event(50, 300);
        e.ramp = 100;
        mixer punctual = make_mixer();
        punctual.add(e);
        const auto want = take(punctual, 400);
        mixer m = make_mixer();
        take(m, 50 + late);
        m.add(e);
        const auto got = take(m, 350 - late);
        CHECK((std::vector<float>(want.begin() + static_cast<std::ptrdiff_t>(2 * (50 + late)), want.end()) ==
               got));
    }
    mixer m = make_mixer();
    take(m, 1000);
    CHECK(m.add(make_event(0, 1000)));
    CHECK(m.size() == 0);
}

TEST_CASE("the order of adding does not change the sound")
{
    std::mt19937_64 random(2);
    std::vector<drive_event> events;
    for (int i = 0; i < 60; ++i)
        events.push_back(make_event(random() % 2000, 1 + static_cast<std::uint32_t>(random() % 700), 0.01));
    mixer a = make_mixer();
    mixer b = make_mixer();
    for (std::size_t i = 0; i < events.size(); ++i) {
        a.add(events[i]);
        b.add(events[events.size() - 1 - i]);
    }
    const auto x = take(a, 3000);
    const auto y = take(b, 3000);
    for (std::size_t i = 0; i < x.size(); ++i)
        REQUIRE(std::abs(x[i] - y[i]) < 1e-6F);
}

TEST_CASE("a full mixer refuses, loses nothing, and takes more when a drive has ended")
{
    mixer m = make_mixer(4);
    for (std::uint32_t i = 0; i < 4; ++i)
        CHECK(m.add(make_event(i * 100, 100)));
    CHECK(m.available() == 0);
    CHECK_FALSE(m.add(make_event(400, 100)));
    CHECK_FALSE(silent(take(m, 100)));
    CHECK(m.available() == 1);
    CHECK(m.add(make_event(400, 100)));
    const auto x = take(m, 400);
    for (std::size_t k = 0; k < 400; ++k)
        CHECK(std::abs(static_cast<double>(x[2 * k]) - 0.5 * sine(hz, k % 100)) < 1e-7);
}

TEST_CASE("drives with non-numbers are silence, and so are missing channels")
{
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {inf, -inf, std::nan("")}) {
        mixer m = make_mixer();
        CHECK(m.add(make_event(0, 100, 0, bad, 0.5)));
        CHECK(m.add(make_event(0, 100, 0, 0.5, bad)));
        drive_event e = make_event(0, 100);
        e.cycles_per_frame = bad;
        CHECK(m.add(e));
        CHECK(m.add(make_event(0, 100, 2, 0.5, 0.5)));
        CHECK(m.add(make_event(0, 0)));
        e = make_event(0, 100, 1, 0.25, 0.25);
        e.drives = 2;
        e.drive[1] = {bad, bad, 0};
        CHECK(m.add(e));
        const auto x = take(m, 100);
        for (std::size_t k = 0; k < 100; ++k)
            CHECK(x[2 * k] == 0.0F);
        CHECK(x[2 * 48 + 1] == doctest::Approx(0.25));
    }
}

TEST_CASE("each channel is held to its limit, and cuts are counted")
{
    mixer m(std::vector<double>{0.25, 0.0}, format_kind::s16, 8);
    m.add(make_event(0, 480, 0, 0.5, 0.5));
    m.add(make_event(0, 480, 0, 1e300, 1e300));
    m.add(make_event(0, 480, 1, 0.5, 0.5));
    std::vector<std::int16_t> x(2 * 480);
    m.process(480, reinterpret_cast<std::byte*>(x.data()));
    std::uint64_t cut = 0;
    for (std::size_t k = 0; k < 480; ++k) {
        CHECK(std::abs(x[2 * k]) <= 8192);
        CHECK(x[2 * k + 1] == 0);
        cut += std::abs(x[2 * k]) == 8192 ? 1 : 0;
    }
    CHECK(cut > 400);
    CHECK(m.counts().limited >= cut);
}

TEST_CASE("no sample is above the limit for any begins and ends within a block")
{
    std::mt19937 random(1);
    const auto below = [&](unsigned n) { return static_cast<std::uint32_t>(random() % n); };
    for (int round = 0; round < 4000; ++round) {
        mixer m(std::vector<double>{0.25, 0.25}, format_kind::float32, 16);
        for (unsigned i = 0; i < 3 + below(3); ++i) {
            const std::uint32_t start = below(300);
            const auto weak = [&] { return below(2) == 0 ? 0.0 : 0.01; };
            drive_event e = below(2) == 0 ? make_line(start, 32 * (1 + below(8)), 0,
                                                      {0.0, weak(), weak(), weak(), weak()})
                                          : make_event(start, 1 + below(200), 0, 0.2, 0.2);
            e.phase_frame = start;
            m.add(e);
        }
        const auto x = take(m, 576, 96 + below(400));
        CHECK(std::all_of(x.begin(), x.end(), [](float v) { return std::abs(v) <= 0.25F; }));
    }
}

TEST_CASE("a faded score goes to zero without a step and is forgotten")
{
    for (const std::size_t block : {1U, 48U, 1000U}) {
        mixer m = make_mixer();
        drive_event e = make_event(0, 48000);
        e.score = 3;
        m.add(e);
        e.start = 1200;
        m.add(e);
        e.start = 5000;
        m.add(e);
        drive_event other = make_event(0, 48000, 1, 0.5, 0.5);
        other.score = 4;
        m.add(other);
        take(m, 1000, block);
        CHECK(m.fade_out(3, 480));
        CHECK(m.size() == 3);
        CHECK(m.add(e));
        CHECK(m.size() == 3);
        const auto x = take(m, 2000, block);
        double largest_step = 0.0;
        for (std::size_t k = 0; k < 2000; ++k) {
            const double g = k < 480 ? 0.5 + 0.5 * std::cos(pi * static_cast<double>(k) / 480.0) : 0.0;
            const auto at = static_cast<double>(1000 + k);
            const double exact = 0.5 * sine(hz, at) + (k < 200 ? 0.0 : 0.5 * sine(hz, at - 1200.0));
            REQUIRE(std::abs(static_cast<double>(x[2 * k]) - g * exact) < 1e-6);
            largest_step =
                k == 0 ? 0.0 : std::max(largest_step, static_cast<double>(std::abs(x[2 * k] - x[2 * k - 2])));
        }
        CHECK(largest_step < 0.04);
        CHECK(std::abs(x[2 * 1000 + 1]) > 0.0F);
        CHECK(m.size() == 1);
        e.start = 4000;
        CHECK(m.add(e));
        CHECK(m.size() == 2);
    }
}

TEST_CASE("a score's gain ramps to the frame, for what sounds and what comes, and leaves others alone")
{
    for (const std::size_t block : {48, 96, 1000}) {
        CAPTURE(block);
        mixer m = make_mixer();
        drive_event e = make_event(0, 48000);
        e.score = 3;
        m.add(e);
        drive_event other = make_event(0, 48000, 1, 0.5, 0.5);
        other.score = 4;
        m.add(other);
        take(m, 1000, block);
        CHECK(m.set_gain(3, 0.25, 960));
        e.start = 2500;
        m.add(e);
        const auto x = take(m, 3000, block);
        for (std::size_t k = 0; k < 3000; ++k) {
            const auto at = static_cast<double>(1000 + k);
            const double g = k < 960 ? 1.0 - 0.75 * static_cast<double>(k) / 960.0 : 0.25;
            const double tone = 0.5 * sine(hz, at);
            const double late = k < 1500 ? 0.0 : 0.5 * sine(hz, at - 2500.0);
            REQUIRE(std::abs(static_cast<double>(x[2 * k]) - g * (tone + late)) < 1e-6);
            REQUIRE(std::abs(static_cast<double>(x[2 * k + 1]) - tone) < 1e-6);
        }
        CHECK(m.set_gain(3, 1.0, 0));
        const auto whole = take(m, 480, block);
        CHECK(std::abs(*std::max_element(whole.begin(), whole.end())) > 0.9F);
    }
}

TEST_CASE("512 scores have gains at once, and a reset ends ramps")
{
    mixer m = make_mixer();
    for (std::uint32_t i = 0; i < 512; ++i)
        CHECK(m.set_gain(i, 0.5, 100));
    CHECK_FALSE(m.set_gain(512, 0.5, 100));
    CHECK(m.set_gain(512, 1.0, 100)); // which it has
    m.forget_gain(7);
    CHECK(m.set_gain(512, 0.5, 48000));
    m.reset();
    drive_event e = make_event(0, 48000);
    e.score = 512;
    m.add(e);
    const auto x = take(m, 480, 96);
    CHECK(*std::max_element(x.begin(), x.end()) == doctest::Approx(0.25).epsilon(0.001));
}

TEST_CASE("a cut is immediate, and fades are refused beyond 256")
{
    mixer m = make_mixer(600);
    for (std::uint32_t i = 0; i < 300; ++i) {
        drive_event e = make_event(0, 48000, 0.001);
        e.score = i;
        m.add(e);
    }
    take(m, 100);
    for (std::uint32_t i = 0; i < 256; ++i)
        CHECK(m.fade_out(i, 1000));
    CHECK_FALSE(m.fade_out(256, 1000));
    CHECK(m.fade_out(0, 1000));
    CHECK(m.fade_out(256, 0));
    CHECK(m.size() == 299);
    CHECK(m.fade_out(5, 0));
    CHECK(m.fade_out(299, 1000));
    CHECK(m.size() == 298);
    take(m, 1000);
    CHECK(m.size() == 42);
    CHECK(m.fade_out(299, 500));
    take(m, 500);
    for (std::uint32_t i = 0; i < 300; ++i)
        CHECK(m.fade_out(i, 0));
    CHECK(m.size() == 0);
    CHECK(silent(take(m, 100)));
}

TEST_CASE("reset drops everything and counts from 0")
{
    mixer m = make_mixer();
    m.add(make_event(0, 1000));
    m.add(make_event(700, 1000));
    take(m, 600);
    m.fade_out(0, 1000);
    m.reset();
    CHECK(m.position() == 0);
    CHECK(m.size() == 0);
    CHECK(m.available() == 64);
    CHECK(silent(take(m, 500)));
    m.reset();
    m.add(make_event(0, 100));
    CHECK_FALSE(silent(take(m, 100)));
}

TEST_CASE("the limits of an array's channels follow its tactors")
{
    array a = row(3);
    a.tactors[1].max_dbfs = -6.0;
    a.tactors[2].channel = 5;
    const auto l = synth::channel_limits(a, 7);
    CHECK(l.size() == 7);
    CHECK(l[0] == 1.0);
    CHECK(l[1] == doctest::Approx(0.501187));
    CHECK(l[2] == 0.0);
    CHECK(l[5] == 1.0);
    CHECK(l[6] == 0.0);
}

} // namespace mixer_test
