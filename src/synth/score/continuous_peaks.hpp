// SPDX-License-Identifier: MIT
/// \file
/// The greatest drive of each tactor in a continuous plan, for the check of a score's peaks.
#pragma once

#include <cstddef>
#include <vector>

#include <tactor/plan.hpp>

namespace tactor::synth {

/// Returns upper bounds of continuous_peaks() without a look at the samples: the greatest intensity for all.
/// Empty where the intensity is not known to be a bound.
std::vector<double> continuous_bounds(const plan& p, std::size_t tactors);

/// Returns the greatest amplitude of each of so many tactors over all samples; between them it is linear.
/// \throws error (bad_input) where the plan drives a tactor that is not there, gives an impossible amplitude,
///         or is out of order.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors);

} // namespace tactor::synth
