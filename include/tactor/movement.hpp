// SPDX-License-Identifier: MIT
/// \file
/// How a target moves along a path: easing, speeds and rests, and how strong it is where.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

/// How a target gets from rest to rest. Where u is the part of the time, from 0 to 1, the part of the way is
enum class easing_kind {
    linear,       ///< u: at once at its speed
    in_out,       ///< u^2 (3 - 2 u): its speed is a parabola, at most 1.5 times the mean
    minimum_jerk, ///< u^3 (10 - 15 u + 6 u^2), as hands reach (Flash and Hogan 1985): at most 1.875 times
};
TACTOR_KIND(easing_kind);

/// A value at a part of the path's length, 0 at its start and 1 at its end.
struct profile_point {
    double part = 0.0;
    double value = 0.0;

    friend bool operator==(const profile_point&, const profile_point&) = default;
};

/// The target stays at a part of the path.
struct rest {
    double part = 0.0;
    double time_s = 0.0;    ///< more than 0
    double intensity = 1.0; ///< factor meanwhile, 0 to 1; 0 is silence

    friend bool operator==(const rest&, const rest&) = default;
};

/// How a target moves along a path. The default is even. A profile is linear between its points, and constant
/// before the first and after the last; parts ascend. Speeds are linear over the way, not over the time:
/// between two of them speed grows or falls exponentially in time.
struct movement {
    /// Time of the whole movement, rests included. None: the speeds give it.
    std::optional<double> duration_s = {};
    /// Of each stretch from rest to rest. The stretch takes the same time as without easing.
    easing_kind easing = easing_kind::linear;
    std::vector<profile_point> speed_mm_s =
        {}; ///< more than 0; with a duration their ratios count. Empty: even
    std::vector<profile_point> intensity = {}; ///< factors, from 0. Empty: 1
    std::vector<rest> rests = {};              ///< by ascending part

    friend bool operator==(const movement&, const movement&) = default;
};

} // namespace v0
} // namespace tactor
