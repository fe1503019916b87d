// SPDX-License-Identifier: MIT
#include "synth/guard/limiter.hpp"

#include <cmath>

#include "synth/mix/mixer.hpp"

namespace tactor::synth {

std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept
{
    // A drive at the limit itself may miss it by an ulp or two of sin(): held, but no event to report.
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
