// SPDX-License-Identifier: MIT
/// \file
/// Work of a request, known before it is done. Pure.
#pragma once

#include <vector>

#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>

#include "server/stroke_options.hpp"

namespace tactor::server {

/// What planning strokes takes. Exact for park2016 and continuous, an upper bound for tactile-brush.
struct planning_work {
    double bursts = 0.0;
    double samples = 0.0; ///< of continuous strokes
    double steps = 0.0;   ///< in time: some 2 to 5 us each
};

/// Estimates the work from durations and options; none for an SOA that the planner refuses.
planning_work estimate_work(const std::vector<stroke>& strokes, const options::wishes& s,
                            const layout& faces);

} // namespace tactor::server
