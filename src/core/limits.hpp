// SPDX-License-Identifier: MIT
// What no array exceeds: beyond it there is a slip of the pen.
#pragma once

namespace tactor::detail {

inline constexpr unsigned max_tactors = 16384;

/// Channels that a PCM or a WAV file can have; a file that names a channel must stay below.
/// Channels that only follow from the index may go on to max_tactors: such an array can be planned and
/// rendered, if not played.
inline constexpr unsigned max_channels = 1024;

/// Coordinates and lengths beyond a kilometre are slips of the unit.
inline constexpr double max_mm = 1e6;

inline constexpr double min_db = -200.0; ///< below the noise of any converter
inline constexpr double max_gain_db = 60.0;

} // namespace tactor::detail
