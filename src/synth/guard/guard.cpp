// SPDX-License-Identifier: MIT
#include "synth/guard/guard.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "synth/mix/mixer.hpp"

namespace tactor::synth {
namespace {

void check_limits(const drive_limits& l)
{
    if (!detail::bounds_of::power_dbfs.holds(l.power_dbfs))
        throw detail::bad_field("power_dbfs", fmt::format("{} dBFS is not one", l.power_dbfs),
                                "give -120 to 60 dB, e.g. 4.77, three channels at full scale");
    if (!detail::bounds_of::drive_s.holds(l.max_drive_s))
        throw detail::bad_field("max_drive_s", fmt::format("{} s is not a limit", l.max_drive_s),
                                "give 0.1 to 3600 s, e.g. 5");
    if (!detail::bounds_of::drive_s.holds(l.window_s))
        throw detail::bad_field("window_s", fmt::format("{} s is no window", l.window_s),
                                "give 0.1 to 3600 s, e.g. 10");
}

} // namespace

guard_settings make_guards(const drive_limits& l, unsigned rate)
{
    check_limits(l);
    guard_settings g;
    g.rate = rate;
    g.power = std::pow(10.0, l.power_dbfs / 10.0);
    if (l.max_drive_s < l.window_s) {
        g.drive_frames = std::round(l.max_drive_s * rate);
        g.leak = l.max_drive_s / (l.window_s - l.max_drive_s);
    }
    return g;
}

std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept
{
    // A drive at the limit may exceed it by an ulp or two of sin(): it is limited, but does not count.
    const double counted = limit * (1.0 + 1e-9);
    std::uint64_t changed = 0;
    for (unsigned i = 0; i < n; ++i)
        changed += std::abs(x[i]) <= counted ? 0 : 1;
    for (unsigned i = 0; i < n; ++i) {
        const double v = x[i] == x[i] ? x[i] : 0.0;
        const double low = v < limit ? v : limit;
        x[i] = low > -limit ? low : -limit;
    }
    return changed;
}

std::vector<double> channel_limits(const array& a, unsigned channels)
{
    std::vector<double> limits(channels, 0.0);
    for (const tactor_spec& t : a.tactors)
        if (t.channel < channels)
            limits[t.channel] = clean_limit(std::pow(10.0, t.max_dbfs / 20.0));
    return limits;
}

} // namespace tactor::synth
