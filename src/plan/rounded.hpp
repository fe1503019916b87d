// SPDX-License-Identifier: MIT
/// \file
/// Times in messages: as few digits as can be, rounded to the side on which they hold.
#pragma once

#include <string>

#include <tactor/path.hpp>

namespace tactor::detail {

/// Times nearer than this are one time, s.
inline constexpr double same_time_s = 1e-9;

/// Returns t in seconds, to the nanosecond, rounded up; "1.2345".
std::string seconds_up(double t_s);
/// Returns t rounded down.
std::string seconds_down(double t_s);

/// Returns "(40.000, 0.000) mm".
std::string place(point p);

} // namespace tactor::detail
