// SPDX-License-Identifier: MIT
/// \file
/// Thresholds that are likely to be wrong.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "study/calibrate/calibration.hpp"

namespace tactor::study {

struct doubtful_threshold {
    unsigned tactor = 0;
    std::string why = {}; ///< a clause: "it is 20.4 dB above the median of the array's (-44.8 dBFS)"
};

/// Returns the array's thresholds at the session's carrier that are more than 12 dB above their median, and
/// those below which the check trials were still right after the second staircase.
std::vector<doubtful_threshold> find_doubtful(const array& a, const calibration_settings& s,
                                              const std::vector<tactor_threshold>& measured);

} // namespace tactor::study
