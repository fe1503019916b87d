// SPDX-License-Identifier: MIT
#include "cli/instant.hpp"

#include <algorithm>
#include <cmath>

namespace tactor::cli {
namespace {

// Bursts are in order of onset and last at most seconds: look back from the first that is later.
void add_bursts(const plan& p, double t_s, instant& now)
{
    auto b = std::upper_bound(p.bursts.begin(), p.bursts.end(), t_s,
                              [](double t, const burst& x) { return t < x.onset_s; });
    constexpr int look_back = 64;
    for (int i = 0; i < look_back && b != p.bursts.begin(); ++i) {
        --b;
        if (t_s >= b->onset_s + b->duration_s)
            continue;
        for (const drive& d : b->drives)
            now.levels[d.tactor] = std::hypot(now.levels[d.tactor], d.amplitude);
        if (!now.target)
            now.target = b->position;
    }
}

void add_continuous(const plan& p, double t_s, instant& now)
{
    if (t_s > p.stroke_duration_s)
        return;
    burst b;
    p.at(t_s, b);
    for (const drive& d : b.drives)
        now.levels[d.tactor] = std::hypot(now.levels[d.tactor], d.amplitude);
    now.target = b.position;
}

} // namespace

instant at_time(const std::vector<placed_plan>& plans, const std::vector<double>& starts_s,
                std::size_t tactors, double t_s)
{
    instant now;
    now.levels.assign(tactors, 0.0);
    for (std::size_t i = 0; i < plans.size(); ++i) {
        const double t = t_s - starts_s[i];
        if (t < 0.0 || t > plans[i].schedule.total_s)
            continue;
        if (plans[i].schedule.at)
            add_continuous(plans[i].schedule, t, now);
        else
            add_bursts(plans[i].schedule, t, now);
    }
    return now;
}

} // namespace tactor::cli
