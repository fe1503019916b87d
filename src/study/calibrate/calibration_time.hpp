// SPDX-License-Identifier: MIT
/// \file
/// Estimates the duration of a calibration.
#pragma once

#include <string>

#include "study/calibrate/calibration.hpp"

namespace tactor::study {

/// Returns "9 tactors, about 480 trials: some 30 minutes" for what is left of a calibration: what a simulated
/// observer needs, with time for the answers.
std::string time_text(const calibration& c);

} // namespace tactor::study
