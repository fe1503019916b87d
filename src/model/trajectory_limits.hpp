// SPDX-License-Identifier: MIT
#pragma once

namespace tactor::detail {

inline constexpr double longest_stroke_s = 86400.0;

/// Intensity is a factor near 1; more than this is a slip.
inline constexpr double max_intensity = 1000.0;

} // namespace tactor::detail
