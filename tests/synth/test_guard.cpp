// SPDX-License-Identifier: MIT
// Limits of a channel, drive time, and the power of all channels together.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/limits/guard.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/tone/make_timbre.hpp"

namespace guard_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 8000;

/// Makes bursts (onset, duration) of full scale on the first `tactors` of as many, and silence until
/// `total_s`.
score loud(unsigned tactors, std::vector<std::pair<double, double>> times, double total_s,
           std::optional<drive_limits> limits, double level_dbfs = 0.0)
{
    std::vector<burst> bursts;
    for (const auto& [onset, duration] : times) {
        std::vector<drive> drives;
        for (unsigned i = 0; i < tactors; ++i)
            drives.push_back({i, 1.0});
        bursts.push_back(make_burst(onset, duration, drives));
    }
    plan p = make_plan(std::move(bursts));
    p.total_s = p.stroke_duration_s = total_s;
    return {row(tactors), {{p, {}}}, {.rate = rate, .level_dbfs = level_dbfs, .limits = limits}};
}

double largest_step(const std::vector<double>& x)
{
    double most = 0.0;
    for (std::size_t i = 1; i < x.size(); ++i)
        most = std::max(most, std::abs(x[i] - x[i - 1]));
    return most;
}

double largest(const std::vector<double>& x, double from_s, double to_s)
{
    double most = 0.0;
    for (auto i = static_cast<std::size_t>(from_s * rate); i < static_cast<std::size_t>(to_s * rate); ++i)
        most = std::max(most, std::abs(x[i]));
    return most;
}

drive_limits no_longest(double power_dbfs)
{
    return {.power_dbfs = power_dbfs, .max_drive_s = 3600.0, .window_s = 10.0};
}

} // namespace

TEST_CASE("a piece within the limits has the same bytes with and without them")
{
    for (const unsigned tactors : {1U, 3U}) {
        const std::vector<std::pair<double, double>> times{{0.0, 2.5}, {3.0, 2.5}};
        for (const format_kind f : all_formats) {
            CHECK((render(loud(tactors, times, 6.0, drive_limits{}), f) ==
                   render(loud(tactors, times, 6.0, {}), f)));
        }
    }
    // Nine at the default level are below the power of three at full scale.
    CHECK((render(loud(9, {{0.0, 1.0}}, 1.0, drive_limits{}, -12.0), format_kind::s32) ==
           render(loud(9, {{0.0, 1.0}}, 1.0, {}, -12.0), format_kind::s32)));
}

TEST_CASE("the gain recovers a while after the loud part")
{
    const score s = loud(9, {{0.0, 0.2}, {1.2, 0.1}}, 1.4, no_longest(4.771212547196624));
    plan quiet = make_plan(
        {make_burst(0.0, 0.2, {{0, 1.0}, {1, 1.0}, {2, 1.0}, {3, 1.0}}), make_burst(1.2, 0.1, {{0, 1.0}})});
    render_options o{.rate = rate, .level_dbfs = 0.0, .limits = no_longest(4.771212547196624)};
    const std::vector<double> x = channel(score(row(4), {{quiet, {}}}, o), 0);
    CHECK(largest(x, 0.05, 0.2) < 0.9);
    CHECK(largest(x, 1.2, 1.3) == doctest::Approx(1.0));
    // A tactor that goes on alone comes back slowly: the power of nine falls by e in 50 ms, three is the
    // limit.
    plan rest = make_plan({make_burst(0.0, 0.2, {}), make_burst(0.2, 0.3, {{0, 1.0}})});
    for (unsigned i = 0; i < 9; ++i)
        rest.bursts[0].drives.push_back({i, 1.0});
    const std::vector<double> y = channel(score(row(9), {{rest, {}}}, o), 0);
    for (const double after_s : {0.02, 0.03, 0.04}) {
        CAPTURE(after_s);
        const double gain = std::sqrt(3.0 / (9.0 * std::exp(-after_s / 0.05)));
        CHECK(largest(y, 0.2 + after_s, 0.204 + after_s) == doctest::Approx(gain).epsilon(0.05));
    }
    CHECK(largest(y, 0.35, 0.45) == doctest::Approx(1.0));
}

TEST_CASE("a tactor may be driven for five seconds, then it fades")
{
    const std::vector<double> five = channel(loud(1, {{1.03, 5.0}}, 8.0, drive_limits{}), 0);
    CHECK((five == channel(loud(1, {{1.03, 5.0}}, 8.0, {}), 0)));

    const std::vector<double> x = channel(loud(1, {{1.03, 20.0}}, 22.0, drive_limits{}), 0);
    CHECK(largest(x, 1.1, 6.02) == doctest::Approx(1.0));
    CHECK(largest(x, 6.06, 8.56) == 0.0); // it rests for 2.52 s, until half of it is left
    CHECK(largest_step(x) <= 2.0 * std::sin(pi * 250.0 / rate) + 1e-3);
    CHECK(largest(x, 8.6, 8.8) == doctest::Approx(1.0));
}

TEST_CASE("an epoch's end does not give a tactor its time back")
{
    drive_limits l{.max_drive_s = 0.5, .window_s = 1.0};
    synth::mixer m(std::vector<double>(1, 1.0), format_kind::float32, 8, synth::make_guards(l, rate));
    const synth::drive_event e = make_event(0, rate, 250.0 / rate, {1.0, 1.0, 0});
    std::vector<float> x(rate);
    for (int epoch = 0; epoch < 2; ++epoch) {
        CHECK(m.add(e));
        m.process(rate / 2 - 100, reinterpret_cast<std::byte*>(x.data()));
        m.reset();
    }
    CHECK(m.counts().drives_cut == 1);
}

TEST_CASE("weak drives do not count, and impossible limits are named")
{
    CHECK((channel(loud(1, {{0.0, 20.0}}, 20.0, drive_limits{}, -41.0), 0) ==
           channel(loud(1, {{0.0, 20.0}}, 20.0, {}, -41.0), 0)));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const drive_limits& l :
         {drive_limits{.power_dbfs = nan}, drive_limits{.max_drive_s = 0.0}, drive_limits{.max_drive_s = nan},
          drive_limits{.window_s = nan}, drive_limits{.window_s = 1e9}, drive_limits{.power_dbfs = -500.0},
          drive_limits{.power_dbfs = 61.0},
          drive_limits{.power_dbfs = std::numeric_limits<double>::infinity()},
          drive_limits{.max_drive_s = 3601.0}})
        CHECK_THROWS_AS(loud(1, {{0.0, 0.1}}, 0.1, l), error);
}

TEST_CASE("non-numbers reach no format")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    for (const format_kind f : all_formats) {
        synth::mixer m(std::vector<double>{1.0, 0.5, nan}, f, 64, synth::make_guards({}, 48000));
        for (const double a : {nan, inf, -inf, 1e308, -1e308, 1e200}) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                synth::drive_event e = make_event(0, 400, c == 2 ? nan : 250.0 / 48000.0, {a, a, c});
                e.drives = 2;
                e.drive[1] = {-a, a, 1};
                m.add(e);
            }
        }
        std::vector<std::byte> out(480 * 3 * sample_bytes(f));
        m.process(480, out.data());
        for (std::size_t i = 0; i < 480 * 3; ++i) {
            if (f == format_kind::float32) {
                const float v = sample<float>(out, i);
                REQUIRE(std::abs(v) <= (i % 3 == 1 ? 0.5F : i % 3 == 2 ? 0.0F : 1.0F));
            } else {
                const auto v = std::abs(static_cast<double>(integer(out, f, i))) / full_scale(f);
                REQUIRE(v <= (i % 3 == 1 ? 0.5 : i % 3 == 2 ? 0.0 : 1.0));
            }
        }
    }
}

} // namespace guard_test

namespace power_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 48000;
constexpr double three = 4.771212547196624; ///< channels at full scale, in dB

using signal = std::vector<double>;

/// Makes a voice that rises and falls along a raised cosine, or at once.
synth::drive_event voice(double start_s, double length_s, double ramp_s, double hz, std::uint32_t channel,
                         double amplitude, double cycles = 0.0)
{
    synth::drive_event e =
        make_event(static_cast<std::uint64_t>(start_s * rate), static_cast<std::uint32_t>(length_s * rate),
                   hz / rate, {amplitude, amplitude, channel});
    e.ramp = std::min(static_cast<std::uint32_t>(ramp_s * rate), e.length / 2);
    e.phase_frame = static_cast<std::uint64_t>(cycles / hz * rate);
    return e;
}

synth::guard_settings limit_power(double dbfs)
{
    return synth::make_guards({.power_dbfs = dbfs, .max_drive_s = 3600.0, .window_s = 10.0}, rate);
}

std::vector<signal> mixed(const std::vector<synth::drive_event>& events, unsigned channels,
                          std::size_t frames, double dbfs)
{
    synth::mixer m(std::vector<double>(channels, 1.0), format_kind::float32, events.size(),
                   limit_power(dbfs));
    for (const synth::drive_event& e : events)
        REQUIRE(m.add(e));
    std::vector<float> all(frames * channels);
    m.process(frames, reinterpret_cast<std::byte*>(all.data()));
    std::vector<signal> x(channels, signal(frames));
    for (std::size_t i = 0; i < all.size(); ++i)
        x[i % channels][i / channels] = static_cast<double>(all[i]);
    return x;
}

/// Returns the energy above 1 kHz relative to the whole, dB.
double above_1_khz(const signal& x)
{
    synth::spectrum a(x.begin(), x.end());
    synth::compute_fourier_sum(a);
    double high = 0.0;
    double all = 0.0;
    for (std::size_t k = 0; k < a.size() / 2; ++k) {
        all += std::norm(a[k]);
        high +=
            static_cast<double>(k) * rate / static_cast<double>(a.size()) > 1000.0 ? std::norm(a[k]) : 0.0;
    }
    return 10.0 * std::log10(high / all);
}

double greatest_power(const std::vector<signal>& x)
{
    double most = 0.0;
    for (std::size_t k = 0; k < x[0].size(); ++k) {
        double sum = 0.0;
        for (const signal& c : x)
            sum += c[k] * c[k];
        most = std::max(most, sum);
    }
    return most;
}

constexpr std::size_t frames = 1 << 16; // 1.37 s

/// Makes random voices that rise and fall over `ramp_s` or more.
std::vector<synth::drive_event> random_voices(std::mt19937_64& random, double ramp_s, bool one_carrier)
{
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<synth::drive_event> all;
    for (int i = 0; i < 40; ++i) {
        const double ramp = ramp_s * (1.0 + 9.0 * unit(random));
        const double length = 2.0 * ramp + 0.3 * unit(random);
        const double start = unit(random) * (1.36 - length);
        const double hz = one_carrier ? 250.0 : 100.0 + 200.0 * unit(random);
        const auto channel = static_cast<std::uint32_t>(random() % 9);
        all.push_back(voice(start, length, ramp, hz, channel, 0.25 * unit(random), unit(random)));
    }
    return all;
}

bool within(double power, double dbfs)
{
    return power <= std::pow(10.0, dbfs / 10.0) * (1.0 + 1e-6); // samples are rounded to floats
}

} // namespace

TEST_CASE("tactors that rise slowly together are held down without a click")
{
    for (const double ramp : {0.1, 0.5}) {
        std::vector<synth::drive_event> nine;
        for (std::uint32_t c = 0; c < 9; ++c)
            nine.push_back(voice(0.05, 1.25, ramp, 250.0, c, 1.0));
        for (const double dbfs : {three, 0.0, -20.0}) {
            CAPTURE(ramp);
            CAPTURE(dbfs);
            const std::vector<signal> x = mixed(nine, 9, frames, dbfs);
            CHECK(above_1_khz(x[0]) < -75.0);
            CHECK(within(greatest_power(x), dbfs));
            CHECK_FALSE(within(greatest_power(x), dbfs - 0.01));
        }
    }
}

TEST_CASE("sounding tactors continue without a click when others begin at once")
{
    std::vector<synth::drive_event> all;
    for (std::uint32_t c = 0; c < 3; ++c)
        all.push_back(voice(0.05, 1.25, 0.2, 250.0, c, 1.0));
    for (std::uint32_t c = 3; c < 9; ++c)
        all.push_back(voice(0.45, 0.3, 0.0, 250.0, c, 1.0));
    for (const double dbfs : {three, -6.0, -20.0}) {
        CAPTURE(dbfs);
        const std::vector<signal> x = mixed(all, 9, frames, dbfs);
        CHECK(above_1_khz(x[0]) < -75.0);
        CHECK(above_1_khz(x[5]) <
              above_1_khz(mixed(all, 9, frames, 60.0)[5])); // bursts have edges themselves
        CHECK(within(greatest_power(x), dbfs));
        // In the end each has the same.
        const auto largest = [&x](unsigned c) {
            const auto at = x[c].begin() + rate / 2;
            return *std::max_element(at, at + rate / 10);
        };
        CHECK(largest(5) == doctest::Approx(largest(0)).epsilon(1e-3));
    }
}

TEST_CASE("random mixes of one carrier or of many are held down without a click")
{
    std::mt19937_64 random(5);
    for (int run = 0; run < tactor::test::rounds(16); ++run) {
        const auto voices = random_voices(random, 0.02, run % 2 == 0);
        for (const double dbfs : {-6.0, -20.0}) {
            const std::vector<signal> x = mixed(voices, 9, frames, dbfs);
            for (std::size_t c = 0; c < x.size(); ++c) {
                CAPTURE(run);
                CAPTURE(dbfs);
                CAPTURE(c);
                CHECK_FALSE(above_1_khz(x[c]) > -65.0); // not a number: it is silent
            }
            CHECK(within(greatest_power(x), dbfs));
        }
    }
}

TEST_CASE("the power is held in the same frames for any block size")
{
    std::mt19937_64 random(7);
    for (int run = 0; run < tactor::test::rounds(8); ++run) {
        const auto voices = random_voices(random, run % 3 == 0 ? 0.0 : 0.005, run % 2 == 0);
        const auto played = [&](std::size_t largest_block) {
            synth::guard_settings g = limit_power(-12.0);
            g.drive_frames = rate / 5;
            g.leak = 2.0 / 3.0;
            synth::mixer m(std::vector<double>(9, 0.4), format_kind::s32, voices.size(), g);
            for (const synth::drive_event& e : voices)
                m.add(e);
            std::vector<std::byte> out(frames * 9 * 4);
            for (std::size_t done = 0; done < frames;) {
                const std::size_t n = std::min(frames - done, 1 + random() % largest_block);
                m.process(n, out.data() + done * 9 * 4);
                done += n;
            }
            CHECK(m.counts().power_limited > 1000);
            return digest(out);
        };
        const std::uint64_t whole = played(1);
        for (const std::size_t largest_block : {2, 48, 96, 513, 5000}) {
            CAPTURE(run);
            CAPTURE(largest_block);
            CHECK(played(largest_block) == whole);
        }
    }
}

TEST_CASE("beats on a tactor keep their part when others begin in the first frame of a block")
{
    constexpr std::size_t begin = std::size_t{20} * 512;
    // At `begin` a sample of the beat is almost zero, and its crest is not.
    std::vector<synth::drive_event> all{voice(0.0, 1.0, 0.1, 250.0, 0, 0.5),
                                        voice(0.0, 1.0, 0.1, 251.0, 0, 0.5)};
    for (std::uint32_t c = 1; c < 9; ++c) {
        all.push_back(voice(0.0, 0.5, 0.0, 250.0, c, 1.0));
        all.back().start = begin;
    }
    const auto played = [&](std::size_t first) {
        synth::mixer m(std::vector<double>(9, 1.0), format_kind::s32, all.size(), limit_power(three));
        for (const synth::drive_event& e : all)
            REQUIRE(m.add(e));
        std::vector<std::byte> out(rate / 2 * 9 * 4);
        m.process(first, out.data());
        m.process(rate / 2 - first, out.data() + first * 9 * 4);
        return digest(out);
    };
    const std::uint64_t in_the_middle = played(begin - 100);
    CHECK(played(begin) == in_the_middle);
    CHECK(played(begin - 1) == in_the_middle);
}

TEST_CASE("few tactors cannot exceed the limit, and are never checked")
{
    std::vector<synth::drive_event> all;
    for (std::uint32_t c = 0; c < 3; ++c) {
        all.push_back(voice(0.0, 0.5, 0.0, 250.0, c, 1.0));
        all.push_back(voice(0.1, 0.3, 0.0, 170.0, c, 1.0));
    }
    CHECK(mixed(all, 3, rate, three) == mixed(all, 3, rate, 60.0));
}

} // namespace power_test
