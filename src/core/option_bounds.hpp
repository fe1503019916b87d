// SPDX-License-Identifier: MIT
/// \file
/// What the numbers of a stroke's options may be, whoever says them: a command line, [defaults], a client.
#pragma once

#include "core/limits.hpp"

namespace tactor::detail {

/// What a number may be.
struct bounds {
    double low = 0.0;
    double high = 0.0;
    bool above_low = false; ///< low itself is not allowed
};

} // namespace tactor::detail

// By the options' names. What a plan needs besides is the planner's to say, in its own words.
namespace tactor::detail::option_bounds {

inline constexpr bounds speed{0.001, 100000.0};
inline constexpr bounds burst{0.0001, 10.0};
inline constexpr bounds slope{0.01, 0.99};
inline constexpr bounds intercept{0.001, 10.0};
inline constexpr bounds carrier{1.0, 384000.0};  // half of the highest rate
inline constexpr bounds noise_seed{0.0, 0x1p53}; // JSON's numbers go so far
inline constexpr bounds texture_mm{0.0, max_mm};
inline constexpr bounds attack{0.0, 10.0};
inline constexpr bounds release{0.0, 10.0};
inline constexpr bounds ramp{0.0, 10.0};
inline constexpr bounds level_dbfs{min_db, 0.0};
inline constexpr bounds sl{-60.0, 100.0};
inline constexpr bounds stevens_exponent{0.1, 3.0};
inline constexpr bounds rate{8000.0, 768000.0};
inline constexpr bounds latency_ms{0.1, 10000.0};

} // namespace tactor::detail::option_bounds
