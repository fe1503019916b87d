// SPDX-License-Identifier: MIT
// Latency from a call to the DAC, on the virtual clock.
#include <cstdio>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "rig.hpp"

namespace latency_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr unsigned period = 48;

struct latencies {
    std::map<std::uint64_t, unsigned> ring; ///< in frames
    std::map<std::uint64_t, unsigned> dac;
};

void print(const char* what, const std::map<std::uint64_t, unsigned>& m)
{
    unsigned n = 0;
    double sum = 0.0;
    for (const auto& [frames, count] : m) {
        n += count;
        sum += static_cast<double>(frames) * count;
    }
    std::printf("%s: least %.2f, mean %.2f, most %.2f periods of %u frames (%u strokes at random phases)\n",
                what, static_cast<double>(m.begin()->first) / period, sum / n / period,
                static_cast<double>(m.rbegin()->first) / period, period, n);
}

// Plays frame by frame, so that a call may come at any phase of a period.
void frames(rig& r, std::uint64_t n)
{
    for (std::uint64_t i = 0; i < n; ++i) {
        r.dac.advance_queued(1);
        r.step();
        r.now -= static_cast<std::int64_t>(1e9 * period / rate); // step() counts a period
        r.now += static_cast<std::int64_t>(1e9 / rate);
        r.control();
    }
}

} // namespace

TEST_CASE("48 frames x 3 at 48 kHz: in the device's buffer within a period, at the DAC within 4")
{
    std::mt19937_64 random(9);
    rig r({.channels = 9, .period = period, .periods = 3});
    frames(r, 500);
    latencies found;
    for (int i = 0; i < 400; ++i) {
        frames(r, 1 + random() % 300);
        const std::uint64_t played = r.status().played;
        const std::uint64_t from = r.dac.captured_frames();
        const stroke_id id = r.submit(tone(0.004));
        // The call wakes the audio thread between two periods.
        r.loop.step(io_kind::again, r.now);
        std::uint64_t waited = 0;
        while (!r.first_sound(from)) {
            frames(r, 1);
            ++waited;
            REQUIRE(waited < 10 * period);
        }
        const std::uint64_t first = *r.first_sound(from) - 1;
        ++found.ring[waited];
        ++found.dac[first - played];
        while (!r.report(id))
            frames(r, 16);
    }
    print("first sample in the device's buffer after", found.ring);
    print("first sample at the DAC after", found.dac);
    CHECK(found.ring.rbegin()->first <= period);
    CHECK(found.dac.rbegin()->first <= 4 * period);
}

} // namespace latency_test
