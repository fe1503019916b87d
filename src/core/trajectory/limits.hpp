// SPDX-License-Identifier: MIT
#pragma once

namespace tactor::detail {

inline constexpr double longest_stroke_s = 86400.0;

/// Of a profile: its slowest place takes no longer than it can be waited for.
inline constexpr double least_speed_mm_s = 1e-6;

/// Intensity is a factor near 1; more than this is a slip.
inline constexpr double max_intensity = 1000.0;

} // namespace tactor::detail
