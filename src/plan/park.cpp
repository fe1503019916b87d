// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "plan/job.hpp"

namespace tactor::detail {
namespace {

constexpr std::size_t bursts_at_once = 1024; // greatest number for one call of a burst_taker

/// Returns the longest SOA, at most the requested SOA, that divides the duration into equal intervals.
/// \throws error (bad_input) if bursts would be shorter than allowed.
double fit_soa(const job& j, double duration_s)
{
    const plan_options& o = j.options;
    const double longest = law_duration_s(o.profile, o.soa_s);
    if (!o.burst_s && !(o.min_duration_s > 0.0 && o.min_duration_s <= longest + same_time_s))
        throw error(error_kind::bad_input, "{timing=fit}",
                    fmt::format("bursts of at least {} do not fit an SOA of {}, which allows at most {}",
                                seconds_text(o.min_duration_s), seconds_text(o.soa_s), seconds_text(longest)),
                    "lower {min_duration_s}, or use a longer SOA")
            .with_field("min_duration_s");
    const double n = std::ceil((duration_s - same_time_s) / o.soa_s);
    const double soa = duration_s / n;
    const double by_law =
        std::max(o.profile.slope * o.min_duration_s + o.profile.intercept_s, o.min_duration_s);
    const double shortest = o.burst_s.value_or(by_law);
    if (soa >= shortest - same_time_s)
        return soa;
    const std::string needs =
        o.burst_s ? fmt::format("leaves {:.3f} s for each, shorter than the bursts of {} s", soa, *o.burst_s)
                  : fmt::format("needs bursts of {:.3f} s, shorter than {} s", law_duration_s(o.profile, soa),
                                o.min_duration_s);
    throw error(error_kind::bad_input, "{timing=fit}",
                fmt::format("{} of {} s in {:.0f} equal intervals {}", j.name(),
                            format_seconds_down(duration_s), n, needs),
                fmt::format("use {} s or {} s, the nearest durations that work",
                            format_seconds_down((n - 1.0) * o.soa_s), format_seconds_up(n * shortest)));
}

} // namespace

void plan_park(const job& j, plan& out)
{
    const double end = j.motion.motion.duration_s();
    const bool one_burst = end < j.options.soa_s - same_time_s;
    const bool fit = j.options.timing == timing_kind::fit && !one_burst;
    const double soa = fit ? fit_soa(j, end) : j.options.soa_s;
    const double count = one_burst ? 1.0 : std::floor((end + same_time_s) / soa) + 1.0;
    check_burst_count(j, count);

    // Rounding may make a fitted SOA shorter than the burst.
    const double duration =
        j.options.burst_s ? std::min(*j.options.burst_s, soa) : law_duration_s(j.options.profile, soa);
    follower target(j);
    const auto all = static_cast<std::size_t>(count);
    out.bursts.reserve(j.take ? std::min(all, bursts_at_once) : all);
    for (double k = 0.0; k < count; ++k) {
        // No burst lasts longer than the SOA, so later bursts do not overlap the bursts that are passed on.
        if (j.take && out.bursts.size() == bursts_at_once)
            deliver_bursts(j, out);
        // Rounding may put the last burst past the end.
        const double t = std::min(k * soa, end);
        out.bursts.push_back(make_burst(j, k * soa, duration, target.at(t), t));
    }
    out.soa_s = soa;
    out.total_s = (count - 1.0) * soa + duration;
}

} // namespace tactor::detail
