// SPDX-License-Identifier: MIT
/// \file
/// Estimates the duration of a session's runs.
#pragma once

#include <cstddef>
#include <vector>

#include "study/session/prepared.hpp"

namespace tactor::study {

/// Time from what was shown before to the first frame of a stimulus, so that nobody is surprised, s.
inline constexpr double stimulus_lead_s = 0.5;

struct run_time {
    double total_s = 0.0;  ///< practice included, the break after the run not
    double waits_s = 0.0;  ///< of total_s: waiting until no tactor would be driven for too long
    std::size_t waits = 0; ///< trials that wait
};

/// Returns the time of each run in the session's order. Each answer takes `answer_s`, the device adds no
/// latency, and the array has rested before.
std::vector<run_time> session_times(const prepared_experiment& p, double answer_s);

} // namespace tactor::study
