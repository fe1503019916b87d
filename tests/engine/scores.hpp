// SPDX-License-Identifier: MIT
/// \file
/// Scores for the tests, and their bytes as the renderer makes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/render.hpp>

namespace tactor::test {

inline constexpr unsigned rate = 48000;

/// Duration of a stroke that still plays when a test gets to it, on a clock a hundred times as fast as time.
/// Below 2^32 frames.
inline constexpr double endless_s = 80'000.0;

/// Nine channels, 3 x 3.
inline array palm()
{
    return make_grid("palm", 3, 3, 20.0, 20.0);
}

/// Bursts of 20 to 90 ms on one to three tactors, each after the other with an SOA of 70 ms.
inline score random_score(std::uint64_t seed, unsigned bursts, unsigned channels = 0, const array& a = palm())
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    plan p;
    for (unsigned k = 0; k < bursts; ++k) {
        burst b;
        b.onset_s = 0.07 * k;
        b.duration_s = 0.02 + 0.05 * uniform(random);
        const auto first = static_cast<unsigned>(random() % (a.tactors.size() - 2));
        for (unsigned i = 0; i <= random() % 3; ++i)
            b.drives.push_back({.tactor = first + i, .amplitude = 0.05 + 0.5 * uniform(random)});
        p.bursts.push_back(b);
        p.total_s = b.onset_s + b.duration_s;
        p.stroke_duration_s = p.total_s;
    }
    return {a, p, {.channels = channels}};
}

/// Makes a burst on one tactor.
inline score tone(double seconds, unsigned tactor = 0)
{
    plan p;
    burst b;
    b.duration_s = seconds;
    b.drives = {{.tactor = tactor, .amplitude = 1.0}};
    p.bursts.push_back(b);
    p.total_s = seconds;
    p.stroke_duration_s = seconds;
    return {palm(), p};
}

/// Renders a score offline, in one call.
inline std::vector<std::byte> rendered(const score& s, format_kind f)
{
    std::vector<std::byte> out(s.frames() * s.channels() * sample_bytes(f));
    renderer(s, f).process(out);
    return out;
}

} // namespace tactor::test
