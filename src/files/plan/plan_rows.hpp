// SPDX-License-Identifier: MIT
/// \file
/// What a plan plays, row by row, for listings.
#pragma once

#include <algorithm>
#include <cstdint>

#include <tactor/plan.hpp>

namespace tactor::files {

/// Calls row(burst) for each burst; for `continuous`, for each point at which the phantom is
/// evaluated (each lasts until the next).
template <class Row>
void for_each_row(const plan& p, Row&& row)
{
    for (const burst& b : p.bursts)
        row(b);
    burst b;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); ++k) {
        p.curve->sample(k, b);
        b.duration_s = std::min(continuous_step_s, p.stroke_duration_s - b.onset_s);
        row(b);
    }
}

} // namespace tactor::files
