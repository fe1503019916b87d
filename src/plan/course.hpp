// SPDX-License-Identifier: MIT
/// \file
/// The frequency of a stroke over time.
#pragma once

#include <vector>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// What plan::course says of a stroke that is played with a waveform.
std::vector<carrier_point> course_of(const stroke& s, const waveform& w);

/// The frequency at a part of the time, 0 to 1, from a point of a course to the next.
double hz_between(const carrier_point& from, const carrier_point& to, double u);

/// The carrier at a part of the path; the profile has points. O(log n).
double hz_at(const std::vector<carrier_part>& profile, double part);

} // namespace tactor::detail
