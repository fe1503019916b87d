// SPDX-License-Identifier: MIT
/// \file
/// Movements that no hand makes: their numbers are likely in another unit.
#pragma once

#include <string>

namespace tactor::detail {

/// Origin of a movement's pace.
enum class pace_source { times, speed, live };

/// Extent of a movement in space and time.
struct travel {
    double length_mm = 0.0;
    double moving_s = 0.0;    ///< without rests
    double farthest_mm = 0.0; ///< largest coordinate, without its sign
    pace_source source = pace_source::times;
};

/// Returns a warning that names the unit that is likely, and the factor: all places within 1 mm of (0, 0),
/// more than a minute below 1 mm/s, or above 5 m/s. Empty for other movements. Live points arrive in real
/// time, so they may be slow. A program may send a whole file at once, so the first second does not count.
std::string doubt_units(const travel& t);

} // namespace tactor::detail
