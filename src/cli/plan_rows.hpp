// SPDX-License-Identifier: MIT
/// \file
/// What a plan plays, row by row, for listings.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>

namespace tactor::cli {

/// Calls row(burst) for each burst; for `continuous`, for each point at which the phantom is
/// evaluated (each lasts until the next).
template <class Row>
void for_each_row(const plan& p, Row&& row)
{
    if (!p.at) {
        for (const burst& b : p.bursts)
            row(b);
        return;
    }
    burst b;
    const auto steps = static_cast<std::uint64_t>(std::ceil(p.stroke_duration_s / continuous_step_s - 1e-9));
    for (std::uint64_t i = 0; i <= steps; ++i) {
        const double t = std::min(static_cast<double>(i) * continuous_step_s, p.stroke_duration_s);
        p.at(t, b);
        b.onset_s = t;
        b.duration_s = std::min(continuous_step_s, p.stroke_duration_s - t);
        row(b);
    }
}

/// Start of each plan of a piece in seconds: its own, or the end of the one before.
inline std::vector<double> starts_of(const std::vector<placed_plan>& plans)
{
    std::vector<double> starts;
    double next = 0.0;
    for (const placed_plan& p : plans) {
        starts.push_back(p.start_s.value_or(next));
        next = starts.back() + p.schedule.total_s;
    }
    return starts;
}

} // namespace tactor::cli
