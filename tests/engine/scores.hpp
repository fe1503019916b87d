// SPDX-License-Identifier: MIT
/// \file
/// Scores for the tests, and their bytes as the renderer makes them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
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

/// Makes a plan that lasts as long as its bursts.
inline plan make_bursts(std::vector<burst> bursts)
{
    plan p;
    for (const burst& b : bursts)
        p.total_s = std::max(p.total_s, b.onset_s + b.duration_s);
    p.stroke_duration_s = p.total_s;
    p.bursts = std::move(bursts);
    return p;
}

/// Bursts of 20 to 90 ms on one to three tactors, each after the other with an SOA of 70 ms.
inline score random_score(std::uint64_t seed, unsigned bursts, unsigned channels = 0, const array& a = palm())
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<burst> all(bursts);
    for (unsigned k = 0; k < bursts; ++k) {
        burst& b = all[k];
        b.onset_s = 0.07 * k;
        b.duration_s = 0.02 + 0.05 * uniform(random);
        const auto first = static_cast<unsigned>(random() % (a.tactors.size() - 2));
        for (unsigned i = 0; i <= random() % 3; ++i)
            b.drives.push_back({.tactor = first + i, .amplitude = 0.05 + 0.5 * uniform(random)});
    }
    return {a, make_bursts(std::move(all)), {.channels = channels}};
}

/// Makes a burst on one tactor.
inline score tone(double seconds, unsigned tactor = 0, const render_options& o = {}, double amplitude = 1.0)
{
    return {palm(), make_bursts({{.duration_s = seconds, .drives = {{tactor, amplitude}}}}), o};
}

/// Plans a stroke as one that moves without a pause.
inline plan make_continuous(const stroke& s, faces_kind faces = {})
{
    plan_options o{.algorithm = algorithm_kind::continuous, .faces = faces};
    return make_plan(palm(), s, o);
}

/// Describes how a stroke ended: state, reason and why, such as "interrupted, lost: the device is gone".
inline std::string ending(const stroke_report& r)
{
    std::string text(to_string(r.state));
    if (r.reason != reason_kind::none)
        text += ", " + std::string(to_string(r.reason));
    return r.why.empty() ? text : text + ": " + r.why;
}

/// Renders a score offline, in one call.
inline std::vector<std::byte> rendered(const score& s, format_kind f)
{
    std::vector<std::byte> out(s.frames() * s.channels() * sample_bytes(f));
    renderer(s, f).process(out);
    return out;
}

} // namespace tactor::test
