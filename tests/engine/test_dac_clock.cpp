// SPDX-License-Identifier: MIT
// The DAC's clock against readings that are off in known ways.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/audio/dac_clock.hpp"

namespace dac_clock_test {

using tactor::engine::clock_line;
using tactor::engine::dac_clock;

namespace {

constexpr double rate = 48000.0;

// A DAC that is `ppm` too fast or slow.
struct truth {
    double ppm = 0.0;
    std::int64_t start_ns = 5'000'000'000'000;
    std::uint64_t first = 0;

    std::int64_t time_at(double frame) const
    {
        return start_ns +
               std::llround((frame - static_cast<double>(first)) * 1e9 / rate * (1.0 + ppm * 1e-6));
    }
    double frame_at(std::int64_t t) const
    {
        return static_cast<double>(first) +
               static_cast<double>(t - start_ns) * rate * 1e-9 / (1.0 + ppm * 1e-6);
    }
};

// Returns the largest error of the line over half a second from a frame on, ns.
double error_ns(const clock_line& line, const truth& t, std::uint64_t frame)
{
    double worst = 0.0;
    for (std::uint64_t f = frame; f <= frame + 24'000; f += 2400)
        worst = std::max(worst,
                         std::abs(static_cast<double>(line.time_at(f) - t.time_at(static_cast<double>(f)))));
    return worst;
}

} // namespace

TEST_CASE("with jitter up to 1 ms and drift up to 1000 ppm, the line stays within its stated bounds")
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> jitter(-1e6, 1e6);
    for (int round = 0; round < 60; ++round) {
        for (const double ppm : {-1000.0, -40.0, 0.0, 40.0, 1000.0}) {
            CAPTURE(ppm);
            const truth t{.ppm = ppm};
            dac_clock clock(48000, 0);
            clock.begin_epoch(0);
            double early = 0.0;
            for (std::uint64_t f = 48; f <= 10 * 48'000; f += 48) {
                clock.add(t.time_at(static_cast<double>(f)) + std::llround(jitter(random)), f);
                REQUIRE(clock.line().frame == f); // taken
                const auto here = std::abs(
                    static_cast<double>(clock.line().time_at(f) - t.time_at(static_cast<double>(f))));
                if (f > 4800)
                    early = std::max(early, here);
                if (f > 5 * 48'000) {
                    REQUIRE(here < 0.1e6);
                    REQUIRE(error_ns(clock.line(), t, f) < 0.15e6);
                }
            }
            CHECK(early < 0.5e6);
        }
    }
}

TEST_CASE("a position in whole periods, read at random times, is late by at most the time between readings")
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> gap(0.1e6, 0.9e6);
    for (const double ppm : {-40.0, 40.0}) {
        const truth t{.ppm = ppm};
        dac_clock clock(48000, 480);
        clock.begin_epoch(0);
        for (std::int64_t now = t.start_ns; now < t.start_ns + 30'000'000'000;
             now += std::llround(gap(random))) {
            const auto period = static_cast<std::uint64_t>(t.frame_at(now)) / 480 * 480;
            clock.add(now, period);
            REQUIRE(clock.line().frame == period); // taken
            if (now < t.start_ns + 10'000'000'000)
                continue;
            const auto late =
                static_cast<double>(clock.line().time_at(period) - t.time_at(static_cast<double>(period)));
            REQUIRE(late > -0.4e6);
            REQUIRE(late < 0.9e6);
        }
    }
}

TEST_CASE("single readings far off change nothing; when all are, the line begins anew")
{
    std::mt19937_64 random(8);
    const truth t{.ppm = 40.0};
    dac_clock clock(48000, 0);
    clock.begin_epoch(0);
    std::uint64_t f = 0;
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        f += 48;
        const bool wrong = i > 100 && random() % 10 == 0;
        clock.add(t.time_at(static_cast<double>(f)) + (wrong ? 30'000'000 : 0), f);
        refused += clock.line().frame != f ? 1 : 0;
        if (i > 1000)
            REQUIRE(error_ns(clock.line(), t, f) < 10e3);
    }
    CHECK(refused > 1000);
    const truth slept{.ppm = 40.0, .start_ns = t.start_ns + 3'000'000'000};
    for (int i = 0; i < 8; ++i) {
        f += 48;
        clock.add(slept.time_at(static_cast<double>(f)), f);
    }
    CHECK(std::abs(clock.line().time_at(f) - slept.time_at(static_cast<double>(f))) < 1000);
    CHECK(clock.line().valid());
}

TEST_CASE("each epoch begins without the one before")
{
    dac_clock clock(48000, 0);
    CHECK_FALSE(clock.line().valid());
    clock.begin_epoch(0);
    CHECK_FALSE(clock.line().valid());
    clock.add(1'000'000, 0); // nothing has moved
    CHECK_FALSE(clock.line().valid());
    clock.add(2'000'000, 48);
    CHECK(clock.line().valid());
    CHECK(clock.line().epoch == 1);
    CHECK(clock.line().time_at(96) == 3'000'000);
    clock.add(90'000'000, 48); // no news
    CHECK(clock.line().time_at(48) == 2'000'000);
    clock.begin_epoch(1000);
    CHECK_FALSE(clock.line().valid());
    CHECK(clock.line().epoch == 2);
    CHECK(clock.line().first == 1000);
    clock.add(500'000'000, 1048);
    CHECK(clock.line().time_at(1000) == 499'000'000);
    CHECK(clock.line().frame_at(501'000'000) == 1096);
}

TEST_CASE("extreme times and frames stay numbers")
{
    dac_clock clock(48000, 0);
    clock.begin_epoch(0);
    clock.add(1'000'000'000, 48'000);
    const clock_line& l = clock.line();
    using limits = std::numeric_limits<std::int64_t>;
    CHECK(l.frame_at(limits::min()) == 0);
    CHECK(l.frame_at(0) == 0);
    CHECK(l.frame_at(limits::max()) > std::uint64_t{1} << 48);
    CHECK(l.time_at(~std::uint64_t{0}) > limits::max() / 2);
    clock.add(limits::max(), 50'000);
    clock.add(limits::min(), 60'000);
    CHECK(l.frame == 48'000); // neither was taken
    CHECK(l.frame_at(l.time_at(123'456)) == 123'456);
}

} // namespace dac_clock_test
