// SPDX-License-Identifier: MIT
#include "session/threshold_carrier.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "session/say.hpp"

namespace tactor::session {
namespace {

// Returns the carrier of a plan that is farthest from this one.
double farthest(const plan& p, double hz)
{
    const auto away = [hz](double f) { return std::abs(f - hz); };
    // For a recording along the path the course has the rate of its repetition.
    if (p.course.empty() || p.wave.kind == waveform_kind::recording)
        return p.carrier_hz;
    return std::max_element(
               p.course.begin(), p.course.end(),
               [&](const carrier_point& a, const carrier_point& b) { return away(a.hz) < away(b.hz); })
        ->hz;
}

} // namespace

std::string other_carrier(const environment& e, std::span<const plan* const> plans)
{
    const auto alone = [](const tactor_spec& t) { return t.threshold_dbfs.has_value(); };
    if (!e.config.calibration || std::none_of(e.tactors.tactors.begin(), e.tactors.tactors.end(), alone))
        return {};
    const double measured_hz = e.config.calibration->carrier_hz;
    for (const plan* p : plans)
        if (const double hz = farthest(*p, measured_hz); hz != measured_hz)
            return fmt::format(
                "the thresholds were measured at {} Hz, and a carrier is {} Hz, where they are "
                "others (tactor calibrate --carrier {} adds to them)",
                measured_hz, hz, hz);
    return {};
}

void tell_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores)
{
    if (!r.sl_db)
        return;
    std::vector<const plan*> plans;
    for (const score& s : scores)
        for (const placed_plan& p : s.plans())
            plans.push_back(&p.plan);
    if (const std::string other = other_carrier(e, plans); !other.empty())
        say(stderr, "tactor: warning: {}\n", other);
}

} // namespace tactor::session
