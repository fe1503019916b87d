// SPDX-License-Identifier: MIT
/// \file
/// The frequency of a stroke over time.
#pragma once

#include <vector>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// What plan::course says of a stroke that is played with a waveform.
std::vector<carrier_point> course_of(const stroke& s, const waveform& w);

/// The carrier at a part of the path; the profile has points.
double hz_at(const std::vector<carrier_part>& profile, double part);

} // namespace tactor::detail
