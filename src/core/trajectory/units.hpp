// SPDX-License-Identifier: MIT
/// \file
/// Warnings about movements that are implausible for a hand, so that their numbers are probably in another
/// unit.
#pragma once

#include <string>

namespace tactor::detail {

/// Source of a movement's pace.
enum class pace_source { times, speed, live };

/// Extent of a movement in space and time.
struct travel {
    double length_mm = 0.0;
    double moving_s = 0.0;    ///< time without rests
    double farthest_mm = 0.0; ///< largest absolute value of a coordinate
    pace_source source = pace_source::times;
};

/// Returns a warning that names the probable unit and the conversion factor, or "" for a plausible movement.
/// Warns if all places are within 1 mm of (0, 0), if the speed is below 1 mm/s for more than a minute, or if
/// it is above 5 m/s. Live points arrive in real time, so they may be slow. A program may send a whole file
/// at once, so live movements of up to a second may be fast.
std::string unit_warning(const travel& t);

} // namespace tactor::detail
